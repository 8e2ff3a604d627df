#include "accuracy/following.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "accuracy/firmware_parts.h"
#include "coprocessor/coprocessor.h"
#include "coprocessor/register_map.h"
#include "peripherals/quantiser.h"
#include "sensor/described_source.h"

namespace capsoc::accuracy {
namespace {

using namespace coprocessor;

constexpr uint64_t sample_cycles = 200;  // more than the latency: one sample in flight
constexpr uint32_t learning = ctrl_calib | ctrl_adc | ctrl_demod | ctrl_block |
                              static_cast<uint32_t>(ReferenceSource::angle) << ctrl_ref_shift;
constexpr uint32_t settling_turns = 6;  // the program's setting `turns`

class Following {
 public:
  explicit Following(const FollowingRun& run)
      : run_(run), rate_hz_(run.signal.sample_rate_hz), source_(run.signal) {
    follower_.longest = static_cast<uint32_t>(std::lround(run.longest_turn_s * rate_hz_));
  }

  FollowingOutcome finish() {
    const auto count = static_cast<uint64_t>(std::llround(run_.duration_s * rate_hz_));
    const auto last_second = count - static_cast<uint64_t>(std::llround(rate_hz_));
    uint64_t frozen = 0, followed = 0;
    for (uint64_t k = 0; k < count; ++k) {
      const Sample sample = next(k);
      if (range_.turn == 0) {
        measure(sample);
        continue;
      }
      submit(sample);
      decide(k);
      if (!outcome_.locked) continue;
      ++followed;
      if (follower_.resting) ++frozen;
      const double off = read(reg_angle) * 0x1p-32 - sample.turns;
      const double error = 360.0 * std::abs(off - std::round(off));
      outcome_.error_deg = std::max(outcome_.error_deg, error);
      if (k >= last_second) outcome_.end_error_deg = std::max(outcome_.end_error_deg, error);
    }
    blind_until(count);
    if (followed != 0) {
      outcome_.frozen_part = static_cast<double>(frozen) / static_cast<double>(followed);
    }
    return outcome_;
  }

 private:
  struct Sample {
    int32_t u, v;
    bool clip;
    double turns;  ///< the true angle
  };

  Sample next(uint64_t k) {
    const auto value = source_.sample(k, static_cast<double>(k) / rate_hz_);
    const auto bits = static_cast<unsigned>(run_.signal.adc_bits);
    const peripherals::Quantised u = peripherals::quantise(value->u, bits);
    const peripherals::Quantised v = peripherals::quantise(value->v, bits);
    const bool clip = u.clipped || v.clipped;
    outcome_.clipped = outcome_.clipped || clip;
    return {u.word, v.word, clip, value->angle_turns};
  }

  /// The first turn, and coefficients of its range.
  void measure(const Sample& sample) {
    start_range_feed(&range_, sample.u, sample.v);
    if (range_.turn == 0) return;
    std::array<int32_t, 6> words{};
    start_range_coefficients(&range_, words.data());
    uint32_t offset = reg_au_lo;
    for (const int32_t word : words) {
      write(offset, 0);
      write(offset + 4, static_cast<uint32_t>(word));
      offset += 8;
    }
    write(reg_ctrl, learning);
  }

  void submit(const Sample& sample) {
    device_.submit(cycle_, sample.u, sample.v, sample.clip);
    cycle_ += sample_cycles;
    device_.advance(cycle_);
  }

  /// What the program does with a sample's result.
  void decide(uint64_t k) {
    const uint32_t angle = read(reg_angle);
    if (!begun_) {
      follower_begin(&follower_, range_.turn, angle);
      adjust();
      begun_ = true;
    } else {
      carry_out(follower_feed(&follower_, angle));
    }
    const uint32_t flags = read(reg_turn_flags);
    const uint32_t ended = flags >> 24;
    if (ended == ended_) return;
    ended_ = ended;
    const bool timed_out = (flags >> 16 & 1) != 0;
    const bool good = (flags >> 22 & 1) != 0;
    if (good) turn_learnt(k);
    carry_out(follower_turn_ended(&follower_, read(reg_turn_samples), timed_out));
  }

  void turn_learnt(uint64_t k) {
    write(reg_ctrl, learning | ctrl_guard);
    ++good_turns_;
    if (outcome_.locked) {
      blind_until(k);
      ++outcome_.turns;
    } else if (good_turns_ == settling_turns) {
      outcome_.locked = true;
      outcome_.locked_s = static_cast<double>(k) / rate_hz_;
    }
    learnt_at_ = k;
  }

  void blind_until(uint64_t k) {
    if (!outcome_.locked) return;
    const double blind_s = static_cast<double>(k - learnt_at_) / rate_hz_;
    outcome_.longest_blind_s = std::max(outcome_.longest_blind_s, blind_s);
  }

  void carry_out(follower_task task) {
    switch (task) {
      case follower_nothing:
        return;
      case follower_freeze:
        return set_steps(0, 0);
      case follower_restart:
        return write(reg_turn_limit, 1);
      case follower_adjust:
        return adjust();
    }
  }

  void adjust() {
    set_steps(follower_step_of_amplitudes(follower_.turn),
              follower_step_of_offsets(follower_.turn));
    write(reg_turn_limit, follower_watchdog(follower_.turn));
  }

  void set_steps(uint32_t amplitudes, uint32_t offsets) {
    for (uint32_t i = 0; i < 6; ++i) {
      write(reg_step_au + 4 * i, i == 2 || i == 5 ? offsets : amplitudes);
    }
  }

  uint32_t read(uint32_t offset) { return device_.read(cycle_, offset, true).value; }
  void write(uint32_t offset, uint32_t value) { device_.write(cycle_, offset, value); }

  const FollowingRun& run_;
  double rate_hz_;
  sensor::DescribedSource source_;
  Coprocessor device_{Options()};
  uint64_t cycle_ = 1;
  start_range range_{};
  follower follower_{};
  bool begun_ = false;
  uint32_t ended_ = 0;
  uint32_t good_turns_ = 0;
  uint64_t learnt_at_ = 0;
  FollowingOutcome outcome_;
};

}  // namespace

FollowingOutcome follow(const FollowingRun& run) {
  return Following(run).finish();
}

}  // namespace capsoc::accuracy
