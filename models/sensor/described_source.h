#pragma once

#include "sensor/motion.h"
#include "sensor/signal_config.h"
#include "sensor/source.h"

namespace capsoc::sensor {

/// A signal computed from its description. The configuration is taken as it is: load() checks the
/// ranges of what a user writes.
class DescribedSource final : public Source {
 public:
  /// With peak-normalised noise or a speed disturbance it first runs through the record to find the
  /// peaks (about 60 ns a sample each).
  explicit DescribedSource(const SignalConfig& config);

  std::optional<SensorValue> sample(uint64_t k, double t_seconds) override;
  void rewind() override { motion_.rewind(); }
  const Description& description() const override { return description_; }

 private:
  /// `course`: DriftConfig::course of the sample's time.
  double signal_u(double theta_turns, double course) const;
  double signal_v(double theta_turns, double course) const;

  SignalConfig config_;
  Description description_;
  Motion motion_;
  RandomSequence noise_u_, noise_v_;
  RandomSequence speed_u_, speed_v_;
  double noise_gain_u_, noise_gain_v_;  ///< what a Gaussian of variance 1 is multiplied by
  double speed_gain_u_ = 0.0, speed_gain_v_ = 0.0;
};

}  // namespace capsoc::sensor
