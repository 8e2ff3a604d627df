// What a program does when it has nothing to do, and what only looks like it. The first byte from
// UART 0 says which; `capsoc run -C run.end_on_idle=S` ends those that are idle.
#include <stdbool.h>

#include "adc.h"
#include "an385.h"
#include "fixed_print.h"
#include "handlers.h"
#include "timer.h"

#define ITM_STIMULUS0 (*(volatile uint32_t*)0xE0000000u)
#define ITM_TER (*(volatile uint32_t*)0xE0000E00u)
#define ITM_TCR (*(volatile uint32_t*)0xE0000E80u)
#define ITM_LAR (*(volatile uint32_t*)0xE0000FB0u)

enum { tick_cycles = AN385_CLOCK_HZ / 1000, half_second = 500, longest_systick = 0x1000000 };

static volatile uint32_t ticks;

// Takes about `cycles`: a turn takes three, one to count and two to branch.
static void compute(uint32_t cycles) {
  for (uint32_t left = cycles / 3; left != 0; --left) __asm volatile("");
}

static void tick_handler(void) {
  ++ticks;
}
// As Zephyr's: the tick comes as late as the counter can say.
static void tickless_handler(void) {
  ++ticks;
  SysTick->LOAD = longest_systick - 1;
  SysTick->VAL = 0;
}
static void timer_handler(void) {
  TIMER0->INTSTATUS = CMSDK_TIMER_INT_Msk;
  TIMER1->INTSTATUS = CMSDK_TIMER_INT_Msk;
  compute(300);
}

static void start_tick(volatile exception_handler* vectors, exception_handler handler) {
  vectors[EXCEPTION_SYSTICK] = handler;
  SysTick->LOAD = tick_cycles - 1;
  SysTick->VAL = 0;
  SysTick->CTRL = 7;
}

static void start_timers(volatile exception_handler* vectors) {
  vectors[EXCEPTION_IRQ0 + TIMER0_IRQn] = vectors[EXCEPTION_IRQ0 + TIMER1_IRQn] = timer_handler;
  timer_start(TIMER0, tick_cycles, true);
  timer_start(TIMER1, tick_cycles + 321, true);
  NVIC_EnableIRQ(TIMER0_IRQn);
  NVIC_EnableIRQ(TIMER1_IRQn);
}

static char chosen(void) {
  while ((UART0->STATE & CMSDK_UART_STATE_RXFULL_Msk) == 0) {
  }
  return (char)UART0->DATA;
}

int main(void) {
  volatile exception_handler* const vectors = take_vectors();
  const char mode = chosen();
  print_text("idle: begins\n");
  switch (mode) {
    case 'n':  // nothing that could wake it
    case 's':  // never sleeps
      break;
    case 'l':
      start_tick(vectors, tickless_handler);
      break;
    case 'd':
      start_timers(vectors);
      break;
    case 'a':
      adc_start(0);
      start_tick(vectors, tick_handler);
      break;
    case 'c':
      compute(3 * AN385_CLOCK_HZ);
      start_tick(vectors, tick_handler);
      break;
    case 'i':
      CoreDebug->DEMCR = CoreDebug_DEMCR_TRCENA_Msk;
      ITM_LAR = 0xC5ACCE55u;
      ITM_TER = ITM_TCR = 1;
      start_tick(vectors, tick_handler);
      break;
    default:
      start_tick(vectors, tick_handler);
      break;
  }
  for (;;) {
    if (mode != 's') __WFI();
    const bool due = ticks % half_second == 0;
    if (mode == 'b') compute(tick_cycles / 2);       // half of the time
    if (mode == 'h') compute(tick_cycles / 20);      // a twentieth
    if (mode == 'p' && due) print_text(".");         // output
    if (mode == 'i' && due) ITM_STIMULUS0 = '.';     // output that no bus sees
    if (mode == 'g' && due) GPIO0->DATAOUT = ticks;  // a lamp
    if (mode == 'r') (void)GPIO0->DATA;              // looks for a key
  }
}
