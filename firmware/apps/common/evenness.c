#include "evenness.h"

#include <math.h>

#define MARK ((INT64_C(1) << 32) / evenness_marks)
#define HALF_TURN (UINT32_C(1) << 31)
// Half the range of 32 normal numbers is 2.1 standard deviations in the mean; 3 are rarely passed.
#define CHANCE 3.0

static int64_t magnitude(int64_t value) {
  return value < 0 ? -value : value;
}

static uint32_t rounded_up(double value) {
  if (!(value < HALF_TURN)) return HALF_TURN;
  return value > 0 ? (uint32_t)ceil(value) : 0;
}

// Marks at equal parts of a turn in the direction that the window has taken. In integers until one
// is passed: there may be little time in a sample.
static void pass_marks(struct evenness* state, int64_t step) {
  const int64_t way = magnitude(state->travel);
  while (state->marks < evenness_marks && way >= (state->marks + 1) * MARK) {
    const int64_t beyond = way - (state->marks + 1) * MARK;
    const double part = step != 0 ? fmin((double)beyond / (double)magnitude(step), 1) : 0;
    state->when[state->marks++] = state->samples - part;
  }
}

void evenness_feed(struct evenness* state, uint32_t angle, uint32_t elapsed) {
  const int32_t way = (int32_t)(angle - state->angle);
  const bool first = !state->any;
  state->angle = angle;
  state->any = true;
  if (first || elapsed == 0) return;
  const int64_t step = elapsed == 1 ? way : way - (int64_t)(state->mean_step * (elapsed - 1));
  if (state->samples == 0 || step > state->longest) state->longest = step;
  if (state->samples == 0 || step < state->shortest) state->shortest = step;
  state->travel += way;
  state->samples += elapsed;
  pass_marks(state, way);
}

// Of the places of the window that ended: behind (negative) or ahead of a steady turn.
static void add_turn(struct evenness* state) {
  double change = 0;
  for (uint32_t i = 0; i + 1 < evenness_marks; ++i) {
    const double steady = state->when[i] * fabs(state->mean_step);
    const double deviation = (double)((i + 1) * MARK) - steady;
    state->sum[i] += deviation;
    if (state->turns != 0)
      change += (deviation - state->before[i]) * (deviation - state->before[i]);
    state->before[i] = deviation;
  }
  state->change += change / (evenness_marks - 1);
  ++state->turns;
}

uint32_t evenness_end_window(struct evenness* state, bool whole) {
  uint32_t jump = 0;
  if (state->samples != 0) {
    const bool enough = whole || state->mean_step == 0;
    if (enough) state->mean_step = (double)state->travel / state->samples;
    if (whole && state->marks + 1 >= evenness_marks) add_turn(state);
    const double mean = state->mean_step;
    jump = rounded_up(fmax((double)state->longest - mean, mean - (double)state->shortest));
  }
  state->samples = 0;
  state->travel = 0;
  state->marks = 0;
  return jump;
}

void evenness_restart(struct evenness* state) {
  state->turns = 0;
  state->change = 0;
  for (uint32_t i = 0; i < evenness_marks; ++i) state->sum[i] = 0;
}

static double half_range(const struct evenness* state) {
  double least = 0, greatest = 0;  // at the window's ends
  for (uint32_t i = 0; i + 1 < evenness_marks; ++i) {
    least = fmin(least, state->sum[i]);
    greatest = fmax(greatest, state->sum[i]);
  }
  return (greatest - least) / 2 / state->turns;
}

uint32_t evenness_deviation(const struct evenness* state) {
  return state->turns == 0 ? HALF_TURN : rounded_up(half_range(state));
}

uint32_t evenness_repeating(const struct evenness* state) {
  if (state->turns < 2) return 0;
  // Two turns that differ by chance differ by twice the variance of one.
  const double variance = state->change / 2 / (state->turns - 1);
  return rounded_up(half_range(state) - CHANCE * sqrt(variance / state->turns));
}
