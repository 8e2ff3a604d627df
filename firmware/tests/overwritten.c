// A line is longer than its buffer: what lies after it on the stack, a return address, is gone. A
// counter that an interrupt changes, too.
#include <stdint.h>

#include "core_cm3.h"
#include "fixed_print.h"

#define NEVER_INLINE __attribute__((noinline))

volatile uint32_t shared;

void SysTick_Handler(void);

void SysTick_Handler(void) {
  shared = shared + 100;  // by the interrupt
}

NEVER_INLINE static void copy(volatile uint8_t* to, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i) to[i] = (uint8_t)(0xE1 + i);  // too far
}

NEVER_INLINE static uint32_t parse(uint32_t length) {
  volatile uint8_t line[8];
  copy(line, length);
  return line[0];  // to nowhere
}

int main(void) {
  SysTick->LOAD = 5000;
  SysTick->CTRL = 7;
  print_text("before\n");
  for (uint32_t i = 0; i < 2000; ++i) shared = shared + 1;  // by the loop
  SysTick->CTRL = 0;
  print_fixed((int32_t)parse(20), 0, 0, 0);  // the call
  return 0;
}
