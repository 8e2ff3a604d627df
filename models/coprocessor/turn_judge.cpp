#include "coprocessor/turn_judge.h"

#include <algorithm>

#include "coprocessor/register_map.h"

namespace capsoc::coprocessor {
namespace {

constexpr int64_t turn_30 = int64_t{1} << 30;
constexpr unsigned alarm_at = 16;
constexpr uint32_t clipped_most = 255;
constexpr uint32_t residue_limit = uint32_t{1} << 28;  // 1/16 turn
// Of a sample; a window with one of them is not good.
constexpr uint32_t sample_faults =
    turn_clipped_mask | turn_radius | turn_mirror | turn_noangle | turn_sat | turn_residue;

uint32_t magnitude(int64_t value) {
  return static_cast<uint32_t>(value < 0 ? -value : value);
}

// s30: difference of two angles in 2^-30 turn, modulo one turn.
int32_t step(uint32_t angle, uint32_t before) {
  const uint32_t difference = ((angle >> 2) - (before >> 2)) << 2;
  return static_cast<int32_t>(difference) / 4;
}

bool one_turn(int32_t winding) {
  const int32_t upper = winding >> 24;  // 1/64 turn
  return (upper >= 61 && upper <= 66) || (upper >= -67 && upper <= -62);
}

uint32_t sample_flags(const JudgedSample& s, bool beyond) {
  return (1u << (s.angle >> 29)) | (beyond ? turn_radius : 0) | (s.mirror ? turn_mirror : 0) |
         (s.no_angle ? turn_noangle : 0) | (s.saturated ? turn_sat : 0) |
         (magnitude(s.residue) >= residue_limit ? turn_residue : 0);
}

void count_clipped(TurnRecord& window) {
  const uint32_t clipped = (window.flags & turn_clipped_mask) >> turn_clipped_shift;
  if (clipped != clipped_most) window.flags += 1u << turn_clipped_shift;
}

bool is_good(uint32_t flags, bool count) {
  const uint32_t faults = sample_faults | turn_timeout | (count ? 0 : turn_winding);
  return (flags & turn_octants_mask) == turn_octants_mask && (flags & faults) == 0;
}

void end_window(TurnJudge& next, bool timeout, bool count) {
  TurnRecord& w = next.window;
  if (timeout) w.flags |= turn_timeout;
  if (next.wild || !one_turn(w.winding)) w.flags |= turn_winding;
  const bool good = is_good(w.flags, count);
  if (good) w.flags |= turn_good;
  next.good_turns = good ? std::min(next.good_turns + 1, 3u) : 0;
  next.last = w;
  next.window = {};
  next.wild = false;
  ++next.turn_count;
}

void count_glitch(TurnJudge& next, bool glitch) {
  if (glitch)
    next.glitches = std::min(next.glitches + 1, alarm_at);
  else if (next.glitches != 0)
    --next.glitches;
  if (next.glitches == alarm_at) next.alarm = true;
  if (next.glitches == 0) next.alarm = false;
}

}  // namespace

bool is_beyond(uint32_t deviation, int32_t det, uint32_t n) {
  return n != 0 && deviation >= (uint64_t{magnitude(det)} * n) >> 8;
}

bool TurnJudge::permits_lock(unsigned turns) const {
  const uint32_t flags = ended ? last.flags : window.flags;
  const bool fault = (flags & sample_faults) != 0;
  return !alarm && good_turns >= turns && (turns == 0 || !fault);
}

int32_t angle_step(const TurnJudge& state, uint32_t angle) {
  return state.any ? step(angle, state.last_angle) : 0;
}

TurnJudge judge(const TurnJudge& state, const JudgedSample& sample, const JudgeSettings& settings,
                bool by_angle) {
  TurnJudge next = state;
  TurnRecord& w = next.window;
  next.deviation = magnitude(int64_t{sample.amplitude} - magnitude(sample.det));
  const bool beyond = is_beyond(next.deviation, sample.det, settings.radius_limit);
  w.radius_max = std::max(w.radius_max, next.deviation);
  w.residue_max = std::max(w.residue_max, magnitude(sample.residue));
  w.det = sample.det;
  w.flags |= sample_flags(sample, beyond);
  if (sample.clip) count_clipped(w);
  ++w.samples;
  const int32_t moved = angle_step(state, sample.angle);
  w.winding = static_cast<int32_t>(static_cast<uint32_t>(w.winding) + static_cast<uint32_t>(moved));
  next.any = true;
  next.last_angle = sample.angle;
  next.travel = w.winding;
  const int32_t half_turns = w.winding >> 29;
  if (half_turns == -4 || half_turns == 3) next.wild = true;

  count_glitch(next, sample.clip || is_beyond(next.deviation, sample.det, settings.alarm_limit));
  const bool full = settings.turn_limit != 0 && w.samples >= settings.turn_limit;
  const bool turned = by_angle ? w.winding >= turn_30 || w.winding < -turn_30 : sample.turn;
  const bool complete = turned && !settings.count;
  next.ended = full || complete;
  if (next.ended) end_window(next, !complete && !settings.count, settings.count);
  if (next.alarm) next.good_turns = 0;
  return next;
}

}  // namespace capsoc::coprocessor
