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

// The angle at which the window began, counted in the direction that it has taken.
static uint32_t origin(const struct evenness* state) {
  return state->travel < 0 ? 0 - state->origin : state->origin;
}

// From there to the first mark.
static int64_t first_mark(const struct evenness* state) {
  return MARK - (int64_t)(origin(state) % (uint32_t)MARK);
}

// Marks at fixed places of the turn, since a window begins where a sample happened to be: places
// that wandered with it would mix up in the mean over many turns. In integers until one is passed:
// there may be little time in a sample.
static void pass_marks(struct evenness* state, int64_t step) {
  const int64_t way = magnitude(state->travel), first = first_mark(state);
  while (state->marks < evenness_marks && way >= first + state->marks * MARK) {
    const int64_t beyond = way - (first + state->marks * MARK);
    const double part = step != 0 ? fmin((double)beyond / (double)magnitude(step), 1) : 0;
    const double when = state->samples - part;
    state->when[state->marks++] = when;
    state->when_sum += when;
  }
}

static void follow_turning(struct evenness* state) {
  if (state->travel > state->most) state->most = state->travel;
  if (state->travel < state->least) state->least = state->travel;
  if (state->most - state->travel > state->back) state->back = state->most - state->travel;
  if (state->travel - state->least > state->forth) state->forth = state->travel - state->least;
}

void evenness_feed(struct evenness* state, uint32_t angle, uint32_t elapsed) {
  const int32_t way = (int32_t)(angle - state->angle);
  const bool first = !state->any;
  state->angle = angle;
  state->any = true;
  if (first) state->origin = angle;
  if (first || elapsed == 0) return;
  const int64_t step = elapsed == 1 ? way : way - (int64_t)(state->mean_step * (elapsed - 1));
  if (state->samples == 0 || step > state->longest) state->longest = step;
  if (state->samples == 0 || step < state->shortest) state->shortest = step;
  state->travel += way;
  follow_turning(state);
  state->distance += magnitude(step);
  state->samples += elapsed;
  pass_marks(state, way);
}

// Adds how far the places of the window that ended are late (negative) or early, compared with a
// steady turn. All have the error of the place where the window began; subtracting their mean
// removes it. Runs within one sample period, which may be short.
static void add_turn(struct evenness* state) {
  const int64_t first = first_mark(state);
  uint32_t place = (uint32_t)((origin(state) + first) / MARK) % evenness_marks;
  const double step = fabs(state->mean_step);
  const double steady_mean = state->when_sum / state->marks * step;
  double way = steady_mean - (state->marks - 1) * (MARK / 2.0);  // of the mark, less the mean
  double change = 0;
  for (uint32_t i = 0; i < state->marks; ++i, way += MARK) {
    const double deviation = way - state->when[i] * step;
    const double other = deviation - state->before[place];
    state->sum[place] += deviation;
    state->before[place] = deviation;
    change += other * other;
    place = (place + 1) % evenness_marks;
  }
  if (state->turns != 0) state->change += change / evenness_marks;
  ++state->turns;
}

// A shaft that turns back in the turn passes places twice: no turn shows less of how even it is.
static bool turned_back(const struct evenness* state) {
  return state->back > 2 * MARK && state->forth > 2 * MARK;
}

uint32_t evenness_end_window(struct evenness* state, bool whole) {
  uint32_t jump = 0;
  if (state->samples != 0) {
    const bool enough = whole || state->mean_step == 0;
    if (enough) state->mean_step = (double)state->travel / state->samples;
    if (whole && state->marks + 1 >= evenness_marks && !turned_back(state)) add_turn(state);
    const double mean = state->mean_step;
    jump = rounded_up(fmax((double)state->longest - mean, mean - (double)state->shortest));
  }
  state->origin = state->angle;
  state->samples = 0;
  state->travel = state->most = state->least = state->back = state->forth = 0;
  state->distance = 0;
  state->when_sum = 0;
  state->marks = 0;
  return jump;
}

uint32_t evenness_excess(const struct evenness* state) {
  if (state->samples == 0) return 0;
  const double longest = fmax((double)state->longest, -(double)state->shortest);
  return rounded_up(longest - 2 * (double)state->distance / state->samples);
}

void evenness_restart(struct evenness* state) {
  state->turns = 0;
  state->change = 0;
  for (uint32_t i = 0; i < evenness_marks; ++i) state->sum[i] = 0;
}

static double half_range(const struct evenness* state) {
  double least = state->sum[0], greatest = state->sum[0];
  for (uint32_t i = 1; i < evenness_marks; ++i) {
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
