// Recursion without end. The stack lies at the bottom of the data SRAM (linker.ld), so the push
// below `stack_guard` is a BusFault, the stacking of that fault fails too, and the core locks up.
#include "fixed_print.h"

static volatile unsigned always = 1;

__attribute__((noinline)) static unsigned descend(unsigned depth) {
  volatile unsigned frame[64];
  frame[depth % 64] = depth;
  if (always) return descend(depth + 1) + frame[depth % 64];
  return frame[0];
}

int main(void) {
  print_text("stackoverflow: descending\n");
  return (int)descend(0);
}
