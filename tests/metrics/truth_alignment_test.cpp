#include "metrics/truth_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/constants.h"

namespace capsoc::metrics {
namespace {

/// Ten turns of 500 samples; the recorded angle lags the channels' by `zero` turns.
class Turns : public sensor::Source {
 public:
  explicit Turns(double zero, bool reversed = false) : zero_(zero), reversed_(reversed) {
    description_.motion = sensor::MotionKind::recorded;
  }

  /// From `first` on, `count` samples are those of `earlier` samples before.
  void send_again(uint64_t first, uint64_t count, uint64_t earlier) {
    first_ = first;
    count_ = count;
    earlier_ = earlier;
  }

  const sensor::Description& description() const override { return description_; }
  void rewind() override {}
  std::optional<sensor::SensorValue> sample(uint64_t index, double /*time_s*/) override {
    if (index >= 5000) return std::nullopt;
    const double recorded = static_cast<double>(index) / 500;
    const bool again = index >= first_ && index < first_ + count_;
    const double angle = recorded + zero_ - (again ? static_cast<double>(earlier_) / 500 : 0);
    const double turned = (reversed_ ? -1 : 1) * angle * two_pi;
    sensor::SensorValue value;
    value.u = 0.1 + 0.6 * std::sin(turned);
    value.v = -0.2 + 0.5 * std::cos(turned + 0.3);
    value.angle_turns = recorded;
    value.has_truth = true;
    return value;
  }

 private:
  sensor::Description description_;
  double zero_;
  bool reversed_;
  uint64_t first_ = 0, count_ = 0, earlier_ = 0;
};

TEST(TruthAlignment, FindsTheZeroOfAnEncoderBesideASensor) {
  Turns turns(0.2);
  const auto found = recorded_alignment(turns);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->zero_turns, 0.2, 1e-9);
  EXPECT_FALSE(found->reversed);
}

TEST(TruthAlignment, FindsTheOtherDirection) {
  Turns turns(0, true);
  const auto found = recorded_alignment(turns);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->reversed);
}

// A fifth of the recording is stale by a third of a turn: that is an error of those samples, and no
// zero of the whole.
TEST(TruthAlignment, StaleSamplesAreNoZero) {
  Turns turns(0);
  turns.send_again(2000, 1000, 167);
  EXPECT_FALSE(recorded_alignment(turns));
}

}  // namespace
}  // namespace capsoc::metrics
