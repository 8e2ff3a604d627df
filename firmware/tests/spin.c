// A fault that ends in the default handler of CMSIS: a branch to itself. With a watchdog (status
// word 1 in the PSRAM) the board helps itself, and the second start ends well.
#include <stdint.h>

#include "an385.h"
#include "fixed_print.h"

#define WANTED (*(volatile uint32_t*)0x21000000u)
enum { plain, with_watchdog, after_watchdog, in_thread_mode };

#define WATCHDOG_LOAD (*(volatile uint32_t*)0x40008000u)
#define WATCHDOG_CONTROL (*(volatile uint32_t*)0x40008008u)
#define WATCHDOG_LOCK (*(volatile uint32_t*)0x40008C00u)

__attribute__((naked)) void HardFault_Handler(void) {
  __asm volatile("b .");
}
__attribute__((naked)) void NMI_Handler(void) {
  __asm volatile("bx lr");
}

int main(void) {
  if (WANTED == after_watchdog) {
    print_text("spin: the watchdog helped\n");
    return 0;
  }
  if (WANTED == in_thread_mode)
    for (;;) {
    }
  if (WANTED == with_watchdog) {
    WANTED = after_watchdog;
    WATCHDOG_LOCK = 0x1ACCE551u;
    WATCHDOG_LOAD = 1000000;
    WATCHDOG_CONTROL = 3;
  }
  print_text("spin: faulting\n");
  (void)*(volatile uint32_t*)0x60000000u;  // a load: its bus error is precise
  return 1;
}
