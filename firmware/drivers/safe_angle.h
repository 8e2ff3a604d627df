// An angle that was checked in its own sample, or the reason why there is none; never a stale one.
//
// Checked are:
// - the copy of the parameters against its complement
// - what the coprocessor has found itself, if its safety mechanisms are on (coprocessor_safety.h)
// - that exactly one more sample was processed
// - the status and error flags
// and, unless they are left out,
// - that the angle belongs to the converter's sample, computed here from the copy
// - the step of the angle against the speed
// Formats as in coprocessor.h.
#ifndef CAPSOC_SAFE_ANGLE_H
#define CAPSOC_SAFE_ANGLE_H

#include <stdbool.h>
#include <stdint.h>

#include "coprocessor.h"

enum safe_angle_state {
  safe_angle_good,
  safe_angle_parity,   // a register of the coprocessor has lost a bit
  safe_angle_misfit,   // its demodulator's error is too large
  safe_angle_jump,     // its angle moved too far
  safe_angle_missed,   // a result was not taken
  safe_angle_copy,     // the copy and its complement differ
  safe_angle_samples,  // no new sample, or more than one
  safe_angle_status,   // no VALID, no LOCK, an alarm, or DIVERGED
  safe_angle_flags,    // CLIP, SAT, ZERO, EARLY, CONFIG or UNSETTLED
  safe_angle_radius,   // the sample is far from the ellipse of the parameters
  safe_angle_inverse,  // the angle is not the one of its sample
  safe_angle_step,     // the angle's step is not the one of the speed
};

struct safe_angle {
  // A1, A2, B1, B2, BETA, PHI, the step of the speed; the largest error of the angle and deviation
  // of its step, 2^-32 turn; whether angles are computed here
  uint32_t copy[10];
  uint32_t complement[10];  // the same, every bit inverted
  uint32_t samples, angle;
};

// With the parameters that the coprocessor has, which were just loaded, between two samples.
// `limit` and `step_limit` 2^-32 turn, below a quarter of a turn. `computes`: angles are computed
// here, too. Clears the error flags.
void safe_angle_begin(struct safe_angle* state, const struct coprocessor_parameters* parameters,
                      uint32_t limit, uint32_t step_limit, bool computes);

// What the coprocessor's safety mechanisms have found so far.
enum safe_angle_state safe_angle_found_by_coprocessor(void);

// To be called once after each result. `*angle` is written if the state is good.
enum safe_angle_state safe_angle_read(struct safe_angle* state, uint32_t* angle);

// A sentence for it; null for the good one.
const char* safe_angle_sentence(enum safe_angle_state state);

// sin(angle), Q1.30, to 5e-6.
int32_t safe_angle_sine(uint32_t angle);

#endif
