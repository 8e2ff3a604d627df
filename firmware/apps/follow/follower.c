#include "follower.h"

// Of a turn that can be judged good.
enum { fewest_samples = 22 };
// Parts of a turn by which the speed is known.
#define PART (INT64_C(1) << 29)
// A part may take as long as half of the turn before: a quarter of its speed.
#define SLOWEST(turn) ((turn) / 2)

static int64_t magnitude(int64_t value) {
  return value < 0 ? -value : value;
}

static uint32_t limited(const struct follower* state, uint64_t samples) {
  if (samples < fewest_samples) return fewest_samples;
  return samples < state->longest ? (uint32_t)samples : state->longest;
}

// Samples of a turn, at the speed at which `samples` moved the shaft by `travel` (2^-32 turn).
static uint32_t turn_at(const struct follower* state, uint32_t samples, int64_t travel) {
  return limited(state, ((uint64_t)samples << 32) / (uint64_t)travel);
}

// 8 / (3 N) and 2 / N in Q1.31.
uint32_t follower_step_of_amplitudes(uint32_t turn) {
  return (uint32_t)((UINT64_C(1) << 34) / ((uint64_t)turn * 3));
}

uint32_t follower_step_of_offsets(uint32_t turn) {
  return (uint32_t)((UINT64_C(1) << 32) / turn);
}

uint32_t follower_watchdog(uint32_t turn) {
  return turn + turn / 2 + 1;
}

static void begin_part(struct follower* state) {
  state->travel = 0;
  state->since = 0;
  state->halfway = 0;
}

void follower_begin(struct follower* state, uint32_t turn, uint32_t angle) {
  state->turn = limited(state, turn);
  state->latest = state->turn;
  state->resting = false;
  state->restarting = false;
  state->angle = angle;
  begin_part(state);
}

// Long rest before the first half of the part says nothing of the speed, so the second half does.
static enum follower_task rest(struct follower* state, int64_t moved) {
  if (state->halfway == 0 && moved >= PART / 2) {
    state->halfway = state->since;
    state->travel_halfway = moved;
  }
  if (moved >= PART) {
    const uint32_t samples = state->since - state->halfway;
    const int64_t travel = moved - state->travel_halfway;
    // One step may be more than half a part.
    if (travel > 0)
      state->turn = turn_at(state, samples, travel);
    else
      state->turn = limited(state, fewest_samples);
    state->latest = state->turn;
    state->resting = false;
    state->restarting = true;
    begin_part(state);
    return follower_restart;
  }
  if (state->since >= SLOWEST(state->longest)) begin_part(state);
  return follower_nothing;
}

enum follower_task follower_feed(struct follower* state, uint32_t angle) {
  state->travel += (int32_t)(angle - state->angle);
  state->angle = angle;
  ++state->since;
  const int64_t moved = magnitude(state->travel);
  if (state->resting) return rest(state, moved);
  if (moved >= PART) {
    state->latest = turn_at(state, state->since, moved);
    begin_part(state);
  } else if (state->since > SLOWEST(state->turn)) {
    state->resting = true;
    state->restarting = false;
    begin_part(state);
    return follower_freeze;
  }
  if (!state->restarting) return follower_nothing;
  state->restarting = false;
  return follower_adjust;
}

// The slower of the turn and its end: an unevenness that repeats itself every turn is no change of
// speed, and what slows down needs smaller steps.
enum follower_task follower_turn_ended(struct follower* state, uint32_t samples, bool timed_out) {
  if (state->resting || state->restarting) return follower_nothing;
  const uint32_t whole = timed_out ? state->turn : samples;
  state->turn = limited(state, whole > state->latest ? whole : state->latest);
  return follower_adjust;
}
