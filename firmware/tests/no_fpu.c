// Floating-point instructions on a processor without an FPU: enabling it does nothing.
#include <stdio.h>

#define CPACR (*(volatile unsigned*)0xE000ED88u)

int main(void) {
  CPACR = 0xF00000u;  // CP10 and CP11
  printf("CPACR %08x\n", CPACR);
  fflush(stdout);
  __asm volatile(".fpu fpv4-sp-d16\n vmov.f32 s0, #1.0\n" : : : "memory");
  puts("an FPU");
  return 0;
}
