// How evenly the angle goes round, from the angles of samples that come in order of time.
//
// A sensor's harmonics move the angle along its circle by the same amount at the same place of
// every turn; where the shaft turns steadily they show as a speed that seems to change. A stale
// sample shows as a jump. Touches no register, so that it runs on a host as well.
#ifndef CAPSOC_EVENNESS_H
#define CAPSOC_EVENNESS_H

#include <stdbool.h>
#include <stdint.h>

// Fixed places of a turn at which the time is kept; the largest harmonic order that is seen is
// half.
enum { evenness_marks = 32 };

struct evenness {
  // Of the window under way. Angles in 2^-32 turn.
  uint32_t angle;   // of the last sample
  bool any;         // there was one; the first only says where the angle is
  uint32_t origin;  // angle of the last sample of the window before
  uint32_t samples;
  int64_t travel;               // since the last sample of the window before
  int64_t most, least;          // of it so far
  int64_t back, forth;          // the longest way from one of them to a later place
  int64_t longest, shortest;    // step of one sample, signed
  int64_t distance;             // all steps without their signs
  uint32_t marks;               // passed so far
  double when[evenness_marks];  // sample at which each was passed, with its fraction
  double when_sum;
  // Over all whole turns.
  uint32_t turns;
  double mean_step;               // of the last whole turn, signed
  double sum[evenness_marks];     // deviations from a steady turn
  double before[evenness_marks];  // those of the turn before
  double change;                  // sum over turns of the mean square change from turn to turn
};

// The angle of the next sample, `elapsed` samples after the one before (1 unless some were missed).
void evenness_feed(struct evenness* state, uint32_t angle, uint32_t elapsed);

// Ends the window with the last sample: a `whole` turn adds to what is known over the turns, if the
// shaft has not turned back in it. Returns the largest difference of a step of one sample from the
// mean step.
uint32_t evenness_end_window(struct evenness* state, bool whole);

// Before that, of a shaft of any motion: by how much its longest step, either way, is more than
// twice the mean length of all.
uint32_t evenness_excess(const struct evenness* state);

// Forgets the turns, for instance when the parameters have changed.
void evenness_restart(struct evenness* state);

// Half the range of the mean deviation from a steady turn; half a turn (2^31) before the first
// whole turn.
uint32_t evenness_deviation(const struct evenness* state);
// The part of it that repeats from turn to turn beyond chance; 0 before the second whole turn.
uint32_t evenness_repeating(const struct evenness* state);

#endif
