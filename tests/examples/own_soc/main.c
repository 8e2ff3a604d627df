// The program of own_soc.h: five ticks, then asleep for good.
#include <stdint.h>

#define TICKER ((volatile uint32_t*)0x40000000)
#define PRINTER (*(volatile uint32_t*)0x40001000)
#define NVIC_ISER0 (*(volatile uint32_t*)0xE000E100)

static volatile uint32_t ticks;

static void tick(void) {
  TICKER[2] = 1;
  ++ticks;
}

static void print(const char* text) {
  while (*text != '\0') PRINTER = (uint8_t)*text++;
}

static void start(void) {
  NVIC_ISER0 = 1;
  TICKER[1] = 50000;
  TICKER[0] = 1;
  for (uint32_t seen = 0; seen != 5; ++seen) {
    while (ticks == seen) __asm volatile("wfi");
    print("tick\n");
  }
  TICKER[0] = 0;
  print("done\n");
  for (;;) __asm volatile("wfi");
}

// Stack pointer, reset, fourteen exceptions that do not happen, interrupt 0.
__attribute__((section(".vectors"), used)) static void (*const vectors[17])(void) = {
    (void (*)(void))0x10000, start, [16] = tick};
