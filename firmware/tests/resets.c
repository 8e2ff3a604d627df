// Runs from the PSRAM, which no reset clears. Brings the board into disorder and resets it, by
// SYSRESETREQ and by the watchdog in turn, as often as the word at `plan` says. Then it starts the
// program whose vector table is at 0, as the reset would have.
#include <stdbool.h>
#include <stdint.h>

#include "an385.h"
#include "clock.h"

typedef void (*handler)(void);
struct vector_table {
  const void* initial_stack;
  handler exceptions[15];  // index: exception number - 1
};

extern uint32_t stack_top[];

typedef struct {
  uint32_t wanted, done, random;
} reset_plan;
#define PLAN ((volatile reset_plan*)0x21F00000u)

#define WORD(address) (*(volatile uint32_t*)(address))
#define WATCHDOG 0x40008000u
#define ACTLR WORD(0xE000E008u)
#define ACTLR_DISDEFWBUF 2u

void start(void);

__attribute__((naked)) static void ignore(void) {
  __asm volatile("bx lr");
}
// A store to a hole between registers is a bus error: on after it.
__attribute__((used)) static void skip_instruction(uint32_t* frame) {
  const bool wide = *(const uint16_t*)frame[6] >= 0xE800u;
  frame[6] += wide ? 4 : 2;
}
__attribute__((naked)) static void fault(void) {
  __asm volatile(
      "mrs r0, msp\n"
      "b skip_instruction\n");
}

__attribute__((section(".vectors"), used)) static const struct vector_table vectors = {
    .initial_stack = stack_top, .exceptions = {start, ignore, fault, fault, fault, fault}};

static uint32_t next_random(void) {
  uint32_t x = PLAN->random != 0 ? PLAN->random : 2463534242u;
  x ^= x << 13;
  x ^= x >> 17;
  x ^= x << 5;
  PLAN->random = x;
  return x;
}

static void scribble(uint32_t base, uint32_t size) {
  for (uint32_t offset = 0; offset < size; offset += 4) WORD(base + offset) = next_random();
}

static void disturb(void) {
  __disable_irq();           // what follows pends and is never taken
  ACTLR = ACTLR_DISDEFWBUF;  // skip_instruction() has to see the store itself
  if ((next_random() & 3) == 0) clock_use_pll(1 + next_random() % 8, 1 + next_random() % 3);
  scribble(0x4000C000u, 0x100);  // coprocessor
  scribble(0x4000D000u, 0x20);   // ADC front-end
  for (uint32_t timer = 0x40000000u; timer <= 0x40002000u; timer += 0x1000) scribble(timer, 0x10);
  for (uint32_t gpio = 0x40010000u; gpio <= 0x40013000u; gpio += 0x1000) scribble(gpio, 0x3C);
  for (uint32_t uart = 0x40004000u; uart <= 0x40009000u; uart += 0x1000) {
    if (uart == WATCHDOG) continue;
    WORD(uart + 0x10) = 16 + next_random() % 100;
    WORD(uart + 0x08) = uart == 0x40004000u ? 0x7E : 0x3F;  // UART 0 sends nothing
    WORD(uart) = next_random();
  }
  WORD(0x40028000u) = next_random();  // LEDs
  WORD(0x4002801Cu) = next_random();  // prescaler
  SysTick->LOAD = next_random() % 10000;
  SysTick->CTRL = 7;
  NVIC->ISER[0] = 0xFFFFFFFFu;
  WORD(0xE000E400u) = next_random();  // priorities
  WORD(0xE000ED14u) |= 0x18;          // traps on division by zero and on unaligned accesses
  WORD(0xE000ED24u) |= 7u << 16;      // fault handlers
  WORD(0xE000ED98u) = 0;              // MPU: one region without access
  WORD(0xE000ED9Cu) = 0x20100000u;
  WORD(0xE000EDA0u) = 0x27;
  WORD(0xE000ED94u) = 5;
}

static void reset_by_watchdog(void) {
  WORD(WATCHDOG + 0xC00) = 0x1ACCE551u;
  WORD(WATCHDOG) = 100 + next_random() % 5000;
  WORD(WATCHDOG + 8) = 3;
  for (;;) {
  }
}

__attribute__((naked)) static void begin(void) {
  __asm volatile(
      "mov r0, #0\n"
      "ldr r1, [r0]\n"
      "msr msp, r1\n"
      "ldr pc, [r0, #4]\n");
}

void start(void) {
  if (PLAN->done == PLAN->wanted) {
    SCB->VTOR = 0;
    begin();
  }
  ++PLAN->done;
  disturb();
  for (volatile uint32_t turns = next_random() % 2000; turns != 0; --turns) {
  }
  if ((PLAN->done & 1) != 0) reset_by_watchdog();
  SCB->AIRCR = 0x05FA0004u;
  for (;;) {
  }
}
