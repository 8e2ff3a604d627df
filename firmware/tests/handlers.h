// A vector table in RAM, so that each test program installs the handlers it is about.
#ifndef CAPSOC_TEST_HANDLERS_H
#define CAPSOC_TEST_HANDLERS_H

#include <stdint.h>
#include <string.h>

#include "core_cm3.h"

enum exception_number {
  EXCEPTION_NMI = 2,
  EXCEPTION_HARD_FAULT,
  EXCEPTION_MEM_MANAGE,
  EXCEPTION_BUS_FAULT,
  EXCEPTION_USAGE_FAULT,
  EXCEPTION_SVCALL = 11,
  EXCEPTION_PENDSV = 14,
  EXCEPTION_SYSTICK,
  EXCEPTION_IRQ0
};

typedef void (*exception_handler)(void);

// Copies the table from address 0 and lets VTOR point to the copy. Aligned to its size, a power of
// two (B3.2.5).
static inline volatile exception_handler* take_vectors(void) {
  static exception_handler table[64] __attribute__((aligned(256)));
  const void* volatile flash = 0;  // the table at address 0 is no null pointer
  memcpy(table, flash, 48 * sizeof table[0]);
  SCB->VTOR = (uint32_t)(uintptr_t)table;
  __DSB();
  return table;
}

// The stacked registers (B1.5.6).
struct exception_frame {
  uint32_t r0, r1, r2, r3, r12, lr, pc, xpsr;
};

// Defines the handler `name`, which calls `body(struct exception_frame*, uint32_t exc_return)` with
// the frame on the stack that EXC_RETURN names.
#define HANDLER_WITH_FRAME(name, body)                                       \
  __attribute__((naked)) static void name(void) {                            \
    __asm volatile(                                                          \
        "tst lr, #4\n ite eq\n mrseq r0, msp\n mrsne r0, psp\n mov r1, lr\n" \
        "push {r1, lr}\n bl " #body "\n pop {r1, pc}\n");                    \
  }

#endif
