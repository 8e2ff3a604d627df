// A branch to an even address leaves Thumb state, which the Cortex-M3 does not have: UsageFault
// INVSTATE at the first instruction there, escalated, lockup.
#include <stdint.h>

#include "fixed_print.h"

int main(void) {
  print_text("evenjump: jumping\n");
  const uint32_t even = (uint32_t)(uintptr_t)&main & ~1u;
  __asm volatile("bx %0" ::"r"(even));
  print_text("evenjump: still here\n");
  return 1;
}
