// Turn judge: whether the results of the last turns can be right. docs/reference/coprocessor.md,
// "Turn judge".
#pragma once

#include <cstdint>

#include "coprocessor/register_map.h"
#include "coprocessor/types.h"

namespace capsoc::coprocessor {

// JUDGE and TURN_LIMIT.
struct JudgeSettings {
  // 2^-8 of |DET|; 0: none
  uint32_t radius_limit = field(description::JUDGE_reset, description::JUDGE_RADIUS_LIMIT_mask);
  uint32_t alarm_limit = field(description::JUDGE_reset, description::JUDGE_ALARM_LIMIT_mask);
  // Good windows that LOCK needs, 0..3; 0: neither does the window under way matter
  unsigned turns = field(description::JUDGE_reset, description::JUDGE_TURNS_mask);
  bool count = false;       // windows of turn_limit samples
  uint32_t turn_limit = 0;  // samples; 0: no time-out

  void visit(Archive& archive);
};

// What a window leaves: registers RADIUS_MAX to TURN_DET and TURN_FLAGS.
struct TurnRecord {
  uint32_t radius_max = 0;   // Q1.31
  uint32_t residue_max = 0;  // 2^-32 turn
  int32_t winding = 0;       // 2^-30 turn, wraps
  uint32_t samples = 0;      // wraps
  int32_t det = 0;           // Q1.31, of the last sample
  uint32_t flags = 0;        // without TURN_COUNT

  void visit(Archive& archive);
};

// What T4 knows of its sample.
struct JudgedSample {
  int32_t amplitude = 0;  // Q1.31, not negative
  int32_t det = 0;        // Q1.31
  int32_t residue = 0;    // 2^-32 turn
  uint32_t angle = 0;     // 2^-32 turn, written or not
  bool clip = false;
  bool saturated = false;
  bool no_angle = false;  // zero or unsettled
  bool mirror = false;
  bool turn = false;  // the reference completes a turn with this sample
};

struct TurnJudge {
  TurnRecord window;  // the one under way
  TurnRecord last;    // the one that ended last
  bool wild = false;  // in this window: travel outside [-1.5, 1.5) turns
  uint8_t turn_count = 0;
  unsigned good_turns = 0;  // 0..3
  unsigned glitches = 0;    // 0..16
  bool alarm = false;
  bool any = false;  // a sample was judged since reset
  uint32_t last_angle = 0;
  // Of the last sample, for nodes.
  uint32_t deviation = 0;  // Q1.31
  int32_t travel = 0;      // 2^-30 turn
  bool ended = false;      // it ended its window

  // LOCK of the last sample, as far as the judge is concerned: not while its window has a sample
  // for which it will not be good, unless LOCK needs no turns.
  bool permits_lock(unsigned turns) const;

  void visit(Archive& archive);
};

// Whether a deviation is at |DET| n / 256 (rounded down) or beyond; never with n = 0.
bool is_beyond(uint32_t deviation, int32_t det, uint32_t n);

// From the angle of the sample before to `angle`, 2^-30 turn; 0 for the first sample.
int32_t angle_step(const TurnJudge& state, uint32_t angle);

// The judge one sample on. by_angle: tracking or angle source, windows are turns of the angle.
TurnJudge judge(const TurnJudge& state, const JudgedSample& sample, const JudgeSettings& settings,
                bool by_angle);

}  // namespace capsoc::coprocessor
