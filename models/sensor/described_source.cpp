#include "sensor/described_source.h"

#include <cmath>

#include "base/constants.h"

namespace capsoc::sensor {
namespace {

// One stream for each use of a seed, so that noise and disturbance with equal seeds differ.
constexpr uint64_t noise_u_stream = 1;
constexpr uint64_t noise_v_stream = 2;
constexpr uint64_t speed_u_stream = 3;
constexpr uint64_t speed_v_stream = 4;

double normalised_gain(double peak, const RandomSequence& sequence, uint64_t record_samples) {
  if (peak == 0.0) return 0.0;
  const double largest = sequence.gaussian_peak(record_samples);
  return largest > 0.0 ? peak / largest : 0.0;
}

double noise_gain(const NoiseConfig& noise, double amplitude, const RandomSequence& sequence) {
  if (noise.peak == 0.0) return noise.sigma;
  return normalised_gain(noise.peak * amplitude, sequence, noise.record_samples);
}

double sine_of_turns(double turns) {
  return std::sin(two_pi * (turns - std::round(turns)));
}
double cosine_of_turns(double turns) {
  return std::cos(two_pi * (turns - std::round(turns)));
}

}  // namespace

DescribedSource::DescribedSource(const SignalConfig& config)
    : config_(config),
      description_(describe(config)),
      motion_(config.motion),
      noise_u_(config.noise.seed, noise_u_stream),
      noise_v_(config.noise.seed, noise_v_stream),
      speed_u_(config.speed_disturbance.seed, speed_u_stream),
      speed_v_(config.speed_disturbance.seed, speed_v_stream),
      noise_gain_u_(noise_gain(config.noise, config.a1, noise_u_)),
      noise_gain_v_(noise_gain(config.noise, config.a2, noise_v_)) {
  const SpeedDisturbanceConfig& speed = config.speed_disturbance;
  speed_gain_u_ = normalised_gain(speed.scale, speed_u_, speed.record_samples);
  speed_gain_v_ = normalised_gain(speed.scale, speed_v_, speed.record_samples);
}

std::optional<SensorValue> DescribedSource::sample(uint64_t k, double t_seconds) {
  if (config_.samples && k >= *config_.samples) return std::nullopt;
  SensorValue value;
  value.has_truth = true;
  value.reference_turns = motion_.angle(k, t_seconds);
  value.angle_turns = modulo_turn(value.reference_turns + config_.phi / two_pi);
  double theta_u = value.angle_turns;
  double theta_v = value.angle_turns;
  if (config_.speed_disturbance.scale != 0.0) {
    const double turned = config_.motion.frequency_hz * t_seconds;
    theta_u += turned * speed_gain_u_ * speed_u_.gaussian(k);
    theta_v += turned * speed_gain_v_ * speed_v_.gaussian(k);
  }
  const double course = config_.drift.course(t_seconds);
  value.u = signal_u(theta_u, course);
  value.v = signal_v(theta_v, course);
  if (noise_gain_u_ != 0.0) value.u += noise_gain_u_ * noise_u_.gaussian(k);
  if (noise_gain_v_ != 0.0) value.v += noise_gain_v_ * noise_v_.gaussian(k);
  return value;
}

double DescribedSource::signal_u(double theta_turns, double course) const {
  double sum = sine_of_turns(theta_turns);
  for (const Harmonic& h : config_.harmonics) {
    if (h.channel != Channel::u) continue;
    sum += h.amplitude * sine_of_turns(h.order * theta_turns + h.phase_rad / two_pi);
  }
  const DriftConfig& drift = config_.drift;
  return config_.a1 * ((1 + drift.a1 * course) * sum + drift.b1 * course) + config_.b1;
}

double DescribedSource::signal_v(double theta_turns, double course) const {
  const DriftConfig& drift = config_.drift;
  double sum = cosine_of_turns(theta_turns + (config_.beta + drift.beta * course) / two_pi);
  for (const Harmonic& h : config_.harmonics) {
    if (h.channel != Channel::v) continue;
    sum += h.amplitude * cosine_of_turns(h.order * theta_turns + h.phase_rad / two_pi);
  }
  return config_.a2 * ((1 + drift.a2 * course) * sum + drift.b2 * course) + config_.b2;
}

}  // namespace capsoc::sensor
