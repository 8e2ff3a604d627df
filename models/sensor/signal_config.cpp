#include "sensor/signal_config.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace capsoc::sensor {

const char* name_of(MotionKind kind) {
  switch (kind) {
    case MotionKind::constant:
      return "constant";
    case MotionKind::ripple:
      return "ripple";
    case MotionKind::shuffled:
      return "shuffled";
    case MotionKind::walk:
      return "walk";
    case MotionKind::swing:
      return "swing";
    case MotionKind::profile:
      return "profile";
    case MotionKind::recorded:
      return "recorded";
  }
  return "unknown";
}

double DriftConfig::course(double t_seconds) const {
  if (period_s) return *period_s / two_pi * std::sin(two_pi * std::fmod(t_seconds / *period_s, 1));
  return until_s ? std::min(t_seconds, *until_s) : 0.0;
}

double DriftConfig::extent_s() const {
  return period_s ? *period_s / two_pi : until_s.value_or(0.0);
}

Description describe(const SignalConfig& config) {
  Description description;
  description.name = config.name;
  description.origin = config.origin;
  description.motion = config.motion.kind;
  const DriftConfig& drift = config.drift;
  const auto unless = [](double rate, double value) {
    return rate == 0.0 ? std::optional<double>(value) : std::nullopt;
  };
  description.a1 = unless(drift.a1, config.a1);
  description.a2 = unless(drift.a2, config.a2);
  description.b1 = unless(drift.b1, config.b1);
  description.b2 = unless(drift.b2, config.b2);
  description.beta = unless(drift.beta, config.beta);
  description.phi = config.phi;
  const bool turns = config.motion.kind == MotionKind::constant ||  //
                     config.motion.kind == MotionKind::ripple;
  if (turns) {
    description.frequency_hz = config.motion.frequency_hz;
    description.reference_hz = config.motion.reference_hz.value_or(config.motion.frequency_hz);
  }
  description.sample_rate_hz = config.sample_rate_hz;
  description.adc_bits = config.adc_bits;
  description.samples = config.samples;
  return description;
}

}  // namespace capsoc::sensor
