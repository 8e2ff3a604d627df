// A division by zero with the trap on: UsageFault, escalated, lockup.
#include "core_cm3.h"
#include "fixed_print.h"

int main(void) {
  print_text("divzero: dividing\n");
  SCB->CCR |= SCB_CCR_DIV_0_TRP_Msk;
  __DSB();
  int quotient;
  __asm volatile("sdiv %0, %1, %2" : "=r"(quotient) : "r"(1), "r"(0));
  print_text("divzero: the division went through\n");
  return quotient != 0 ? 1 : 2;
}
