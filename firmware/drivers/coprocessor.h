// Self-calibration coprocessor. Formats: amplitudes and offsets Q1.31, angles 2^-32 turn, phase and
// frequency 2^-48 turn (a sample), coefficients Q2.46, steps (2 mu) unsigned Q1.31.
#ifndef CAPSOC_COPROCESSOR_H
#define CAPSOC_COPROCESSOR_H

#include <stdbool.h>
#include <stdint.h>

#include "capsoc_device.h"

// U = a_u sin + b_u cos + c_u, V = a_v sin + b_v cos + c_v of the reference phase.
enum coprocessor_coefficient {
  coefficient_a_u,
  coefficient_b_u,
  coefficient_c_u,
  coefficient_a_v,
  coefficient_b_v,
  coefficient_c_v,
};

// The six parameters: U = a1 sin(theta + phi) + b1, V = a2 cos(theta + phi + beta) + b2.
struct coprocessor_parameters {
  int32_t a1, a2, b1, b2;
  uint32_t beta, phi;
};

bool coprocessor_present(void);
// Soft reset: everything but ID as after power-up.
void coprocessor_reset(void);

int64_t coprocessor_frequency(void);
void coprocessor_set_frequency(int64_t word);
// The frequency word for `speed` (2^-48 Hz) at a sample every `period` cycles of a clock of
// `clock_hz`. False, with `*word` untouched, unless that is less than half a turn a sample.
bool coprocessor_frequency_word(int64_t speed, uint32_t period, uint32_t clock_hz, int64_t* word);
uint64_t coprocessor_phase(void);
void coprocessor_set_phase(uint64_t word);
int64_t coprocessor_coefficient(enum coprocessor_coefficient which);
// Beyond +-2 the coprocessor clamps.
void coprocessor_set_coefficient(enum coprocessor_coefficient which, int64_t value);
// The same step for all six coefficients. False, with CONFIG raised, if it is 1.0 or more.
bool coprocessor_set_steps(uint32_t step);
// Half of omega (radians a sample), the fastest step that settles, but no more than 1/16.
uint32_t coprocessor_fastest_step(int64_t frequency_word);
// phase += e >> kp, frequency += e >> ki a sample, both 0 to 31; ki = 2 kp + 2 is well damped.
void coprocessor_set_loop(uint32_t kp, uint32_t ki);

// Consistent if called between two results.
struct coprocessor_parameters coprocessor_read_parameters(void);
// Writes the parameters and makes coefficients of them.
void coprocessor_load_parameters(const struct coprocessor_parameters* parameters);

// Reverses the reference and the coefficients with it: frequency, phase and sine coefficients
// change sign. That keeps the fit to the signal (cos(-x) = cos x, sin(-x) = -sin x) and makes the
// mirrored solution the straight one. To be called between two samples, numeric reference.
void coprocessor_reverse_reference(void);

// LOCK by the turns alone: an error that is small in volts says nothing of a signal that is small,
// too, and refuses a large one with a little noise. The alarm is set at the turns' own limit, for
// what breaks after the last whole turn.
void coprocessor_lock_by_turns(void);

// Feeds one sample without the ADC.
void coprocessor_submit(int32_t u, int32_t v);

#endif
