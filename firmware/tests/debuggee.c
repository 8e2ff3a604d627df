// Something to debug: a loop that writes one variable and reads another one, an interrupt handler,
// and a fault or a sleep on request. 400 rounds, then status 0.
#include <stdint.h>

#include "core_cm3.h"
#include "fixed_print.h"

volatile uint32_t written, settings = 7, seen, ticks, crash_wanted, sleep_wanted;

void SysTick_Handler(void);
void HardFault_Handler(void);

void SysTick_Handler(void) {
  ticks = ticks + 1;
}

void HardFault_Handler(void) {
  for (;;) {
  }
}

static uint32_t __attribute__((noinline)) fetch(const volatile uint32_t* place) {
  return *place + 1;
}

static uint32_t __attribute__((noinline)) crash(uint32_t distance) {
  return fetch((const volatile uint32_t*)(0x60000000u + distance)) + 1;
}

static uint32_t __attribute__((noinline)) work(uint32_t round) {
  written = round;
  seen = settings;
  if (crash_wanted != 0) return crash(round & 0xFC);
  return written + seen;
}

int main(void) {
  SysTick->LOAD = 999;
  SysTick->VAL = 0;
  SysTick->CTRL = 7;
  uint32_t sum = 0;
  for (uint32_t round = 1; round <= 400; ++round) sum += work(round);
  while (sleep_wanted != 0) __asm volatile("wfi");
  SysTick->CTRL = 0;
  print_text(sum == 400 * 401 / 2 + 400 * 7 ? "debuggee: right\n" : "debuggee: wrong\n");
  return 0;
}
