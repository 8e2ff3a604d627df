// When a shaft of any speed may be learnt by blocks of a turn, and with which steps: decided from
// the angles that the coprocessor finds, sample by sample, and from its turns. Touches no register,
// so that it runs on a host as well (`capsoc accuracy --table drift`).
//
// A block is good for a shaft whose speed is known within some: the steps are 2 / N and 1 / N for a
// turn of N samples. Faster is harmless, for the block then corrects less. Slower is not: samples
// of one place would weigh too much. So what takes four times as long as the last turn did counts
// as rest: nothing is learnt until an eighth of a turn has passed again, and then with a fresh
// turn.
#ifndef CAPSOC_FOLLOWER_H
#define CAPSOC_FOLLOWER_H

#include <stdbool.h>
#include <stdint.h>

struct follower {
  uint32_t longest;  // samples of the slowest turn that is learnt; the caller's
  uint32_t turn;     // samples of a turn that steps and watchdog are for, 22 .. longest
  bool resting;
  // The rest is its own.
  uint32_t angle;    // of the sample before
  int64_t travel;    // since the last whole part, 2^-32 turn
  uint32_t since;    // samples of it
  uint32_t halfway;  // of them up to half of the part; 0: not yet there
  int64_t travel_halfway;
  uint32_t latest;  // samples of a turn at the speed of the last part
  bool restarting;  // the window before is being cut short
};

// What the caller has to do.
enum follower_task {
  follower_nothing,
  follower_freeze,   // steps of 0: what is learnt stays, whatever comes
  follower_restart,  // cut the present window and its block short: TURN_LIMIT = 1
  follower_adjust,   // steps and watchdog for `turn`
};

// Steps, Q1.31, for a turn of `turn` samples with the angle as reference. Half of an offset's error
// is hidden in that angle, so its block is taken twice. Of the errors of amplitudes and phase, one
// part is half hidden and the other not at all: 4/3 removes two thirds of either.
uint32_t follower_step_of_amplitudes(uint32_t turn);
uint32_t follower_step_of_offsets(uint32_t turn);
// Of TURN_LIMIT: one and a half turns.
uint32_t follower_watchdog(uint32_t turn);

// `longest` is set. `turn`: samples of the turn that was seen, `angle`: the present one.
void follower_begin(struct follower* state, uint32_t turn, uint32_t angle);
// The next sample's angle, 2^-32 turn.
enum follower_task follower_feed(struct follower* state, uint32_t angle);
// A window of the turn judge has ended after `samples`, by a turn or by the watchdog.
enum follower_task follower_turn_ended(struct follower* state, uint32_t samples, bool timed_out);

#endif
