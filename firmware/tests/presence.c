// "Stop here if a debugger is attached", as many assert macros do: tests DHCSR.C_DEBUGEN.
#include <stdint.h>

#include "fixed_print.h"

#define DHCSR (*(volatile uint32_t*)0xE000EDF0u)

int main(void) {
  DHCSR = 0xA05F0001u;  // a program cannot enable it
  if ((DHCSR & 1) != 0) {
    print_text("a debugger is there\n");
    __asm volatile("bkpt 1");
  } else {
    print_text("no debugger\n");
  }
  return 0;
}
