// The coprocessor's safety mechanisms (SAFETY, docs/reference/coprocessor.md): a test of each at
// the start of a program, and their use while it runs.
#ifndef CAPSOC_COPROCESSOR_SAFETY_H
#define CAPSOC_COPROCESSOR_SAFETY_H

#include <stdbool.h>
#include <stdint.h>

// What they have found since FLAGS was cleared: COPROCESSOR_FLAGS_PARITY_Msk, MISFIT, JUMP, MISSED.
uint32_t coprocessor_safety_found(void);

// Makes each mechanism find what it is for, and checks that it finds nothing else. Tested are the
// parity bit of every register, each limit of the error in both channels, steps, and a result that
// software does not take. The samples come from software, so the converter must be off. Leaves the
// coprocessor as after a reset.
// Null, or a sentence about the first one that fails.
const char* coprocessor_safety_test(void);

// Those that need no limit, and all: COPROCESSOR_SAFETY_PARITY_Msk, MISFIT, JUMP, MISSED.
#define COPROCESSOR_SAFETY_WITHOUT_LIMITS \
  (COPROCESSOR_SAFETY_PARITY_Msk | COPROCESSOR_SAFETY_MISSED_Msk)
#define COPROCESSOR_SAFETY_ALL \
  (COPROCESSOR_SAFETY_WITHOUT_LIMITS | COPROCESSOR_SAFETY_MISFIT_Msk | COPROCESSOR_SAFETY_JUMP_Msk)

// Switches `mechanisms` on and the others off. Errors up to `error` (Q1.31) and steps up to `step`
// (2^-32 turn) are good; the limits are the next powers of two. Clears their flags. To be called
// between two samples.
void coprocessor_safety_begin(uint32_t mechanisms, uint32_t error, uint32_t step);

#endif
