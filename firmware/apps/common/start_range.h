// Parameters to start with, from the range of the first samples. With the reset's coefficients, the
// angle of a signal whose offset exceeds its amplitude does not go round the turn, and that angle
// would be learnt.
#ifndef CAPSOC_START_RANGE_H
#define CAPSOC_START_RANGE_H

#include <stdbool.h>
#include <stdint.h>

// Q1.31. Starts as {0}.
struct start_range {
  uint32_t samples;
  uint32_t turn;  // samples until the curve closed; 0: not yet
  int32_t u_least, u_greatest, v_least, v_greatest;
  int32_t v_at_least, v_at_greatest;  // V where U was that
  int32_t u_first, v_first, u_last, v_last;
  uint32_t u_step, v_step;  // the largest from one sample to the next
  bool away;                // the curve has left its beginning
};

// A curve has closed when it comes back to an eighth of its range from its first sample, in both
// channels. As long as the range is below eight times the largest step it may be noise.
void start_range_feed(struct start_range* range, int32_t u, int32_t v);

// Amplitudes and offsets, without a phase error.
struct start_values {
  int32_t a1, a2, b1, b2;
};
struct start_values start_range_values(const struct start_range* range);
// The coefficients a_u, b_u, c_u, a_v, b_v, c_v, with the phase error from V at the extremes of U.
// For samples of a whole turn.
void start_range_coefficients(const struct start_range* range, int32_t coefficients[6]);

// Either into the coprocessor (start_load.c): without and with the phase error.
void start_range_load(const struct start_range* range);
void start_range_load_with_phase(const struct start_range* range);

#endif
