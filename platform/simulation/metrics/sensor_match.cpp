#include "metrics/sensor_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "metrics/metrics.h"

namespace capsoc::metrics {
namespace {

using Reference = SamplingState::Reference;

// Rates in files are rounded, and a program's is a whole number of its clock's cycles.
constexpr double rate_tolerance = 1e-3;

// The default program guarantees 0.19 degrees with a reference that is off by 1e-4, and for 0.66
// with 5e-4.
constexpr double speed_tolerance = 2e-4;

// Where nothing says how long a turn is.
constexpr uint64_t default_settling = 500;

/// A number as a person writes it: 250, 0.051.
std::string figure(double value) {
  return fmt::format("{:.6g}", value);
}

bool differ(double a, double b, double tolerance) {
  return std::fabs(a - b) > tolerance * std::fabs(b);
}

bool same_setting(const SamplingState& a, const SamplingState& b) {
  // A reference that is turned round has the same speed.
  return a.demodulating == b.demodulating && a.reference == b.reference &&
         a.period_cycles == b.period_cycles && a.rate_hz == b.rate_hz &&
         std::abs(int64_t{a.frequency} * 2 + 1) == std::abs(int64_t{b.frequency} * 2 + 1);
}

/// Calls `take` with the turns from each sample of a recording to the next. False: a sample has no
/// true angle. Rewinds the source.
template <typename Take>
bool each_step(sensor::Source& source, Take take) {
  std::optional<double> before;
  bool known = true;
  source.rewind();
  for (uint64_t k = 0; known; ++k) {
    const auto value = source.sample(k, 0);
    if (!value) break;
    known = value->has_truth;
    if (known && before) take(turn_difference(value->angle_turns, *before));
    before = value->angle_turns;
  }
  source.rewind();
  return known;
}

}  // namespace

std::optional<double> recorded_speed(sensor::Source& source) {
  if (source.description().motion != sensor::MotionKind::recorded) return std::nullopt;
  double net = 0, travelled = 0;
  uint64_t steps = 0;
  const bool known = each_step(source, [&](double step) {
    net += step;
    travelled += std::fabs(step);
    ++steps;
  });
  // Random angles go a quarter of a turn on average, as often back as forth.
  const bool steady = known && steps > 0 && std::fabs(net) > 0.9 * travelled;
  if (!steady) return std::nullopt;
  // Where rows are missing, a step is that of many.
  const double longest = 3 * travelled / static_cast<double>(steps);
  double regular = 0;
  uint64_t regular_steps = 0;
  each_step(source, [&](double step) {
    if (std::fabs(step) > longest) return;
    regular += step;
    ++regular_steps;
  });
  return regular / static_cast<double>(regular_steps);
}

SensorMatch::SensorMatch(std::string file, const sensor::Description& description,
                         std::optional<double> speed, Warn warn)
    : file_(std::move(file)), description_(description), speed_(speed), warn_(std::move(warn)) {}

void SensorMatch::result(const SamplingState& state) {
  if (judged_) return;
  if (!state.demodulating || state.reference == Reference::angle) return;
  // A program that steers its reference (track) looks for the speed itself.
  if (same_ == 0 || !same_setting(state, state_)) {
    state_ = state;
    same_ = 0;
  }
  ++same_;
  const double turns =
      description_.frequency_hz ? *description_.frequency_hz / state_.rate_hz : speed_.value_or(0);
  const double two_turns = turns != 0 ? 2 / std::fabs(turns) : default_settling;
  if (static_cast<double>(same_) >= two_turns) judge();
}

void SensorMatch::finish() {
  if (!judged_ && same_ > 0) judge();
}

void SensorMatch::judge() {
  judged_ = true;
  judge_motion();
  if (description_.motion == sensor::MotionKind::recorded) judge_rate();
  if (state_.reference == Reference::numeric) judge_speed();
}

void SensorMatch::judge_motion() {
  using sensor::MotionKind;
  const MotionKind motion = description_.motion;
  if (motion == MotionKind::shuffled)
    say("the sensor's angles come in random order and the program's reference turns steadily: take "
        "a program whose reference is the angle (unordered.elf)");
  if (state_.reference != Reference::numeric) return;
  const bool ripples = motion == MotionKind::ripple, runs = motion == MotionKind::profile;
  if (ripples || runs || motion == MotionKind::walk || motion == MotionKind::swing)
    say(
        fmt::format("the sensor does not turn at a constant speed (its motion is '{}') and the "
                    "program's reference does: take a program whose reference {}",
                    sensor::name_of(motion),
                    ripples ? "follows it (track.elf)"
                    : runs  ? "is the angle, at any speed (follow.elf)"
                            : "is the angle (unordered.elf)"));
}

double SensorMatch::recorded_rate() const {
  return description_.sample_rate_hz.value_or(state_.rate_hz);
}

void SensorMatch::judge_rate() {
  const double tolerance = std::max(rate_tolerance, 1.0 / state_.period_cycles);
  if (!differ(state_.rate_hz, recorded_rate(), tolerance)) return;
  say(
      fmt::format("the trace was sampled at {} Hz and the program samples at {} Hz: to the program "
                  "the sensor turns {} times as fast as it did. Give the program the trace's rate "
                  "(-P rate_hz={}), or resample the trace",
                  figure(recorded_rate()), figure(state_.rate_hz),
                  figure(state_.rate_hz / recorded_rate()), figure(recorded_rate())));
}

void SensorMatch::judge_speed() {
  const bool recorded = description_.motion == sensor::MotionKind::recorded;
  if (recorded ? !speed_ : !description_.frequency_hz) return;
  const double a_sample =
      std::fabs(recorded ? *speed_ : *description_.frequency_hz / state_.rate_hz);
  const double sensor_hz = a_sample * (recorded ? recorded_rate() : state_.rate_hz);
  // The lower 16 bits are anything between none and all.
  const double word = (state_.frequency + 0.5) * 0x1p-32;
  const double reference_hz = std::fabs(word) * state_.rate_hz;
  const auto off = [&](double speed, double known) {
    return std::fabs(speed - known) > std::max(speed_tolerance * known, 0x1p-32 * state_.rate_hz);
  };
  // Either is enough: a trace at another rate may turn as the program expects, sample by sample, or
  // in Hz, and then the rate is all that is to be said.
  if (!off(reference_hz, sensor_hz) || !off(reference_hz, a_sample * state_.rate_hz)) return;
  say(fmt::format(
      "the sensor turns at {} Hz and the program's reference at {} Hz: give the program "
      "the sensor's speed, or take one that measures it (track.elf)",
      figure(sensor_hz), figure(reference_hz)));
}

void SensorMatch::say(const std::string& sentence) {
  warn_(file_ + ": " + sentence);
}

void SamplingState::visit(Archive& archive) {
  archive("demodulating", demodulating);
  archive.at_most("reference", reference, Reference::angle);
  archive("rate_hz", rate_hz);
  archive("period_cycles", period_cycles);
  archive("frequency", frequency);
}

void SensorMatch::visit(Archive& archive) {
  archive("state", state_);
  archive("same", same_);
  archive("judged", judged_);
}

}  // namespace capsoc::metrics
