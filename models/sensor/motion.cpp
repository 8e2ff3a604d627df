#include "sensor/motion.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace capsoc::sensor {
namespace {

constexpr uint64_t motion_stream = 0;

}  // namespace

double modulo_turn(double x) {
  const double fraction = x - std::floor(x);
  return fraction < 1.0 ? fraction : 0.0;  // -1e-20 would round up to 1
}

double product_modulo_turn(double a, double b) {
  const double product = a * b;
  const double rounding_error = std::fma(a, b, -product);
  return modulo_turn(modulo_turn(product) + rounding_error);
}

Motion::Motion(const MotionConfig& config) : config_(config), random_(config.seed, motion_stream) {
  double angle = 0.0;
  for (std::size_t i = 0; i < config_.speeds.size(); ++i) {
    at_points_.push_back(angle);
    if (i + 1 == config_.speeds.size()) break;
    const SpeedPoint &from = config_.speeds[i], &to = config_.speeds[i + 1];
    const double mean_hz = (from.speed_hz + to.speed_hz) / 2;
    angle = modulo_turn(angle + product_modulo_turn(mean_hz, to.time_s - from.time_s));
  }
}

double Motion::angle(uint64_t k, double t_seconds) {
  switch (config_.kind) {
    case MotionKind::constant:
    case MotionKind::ripple: {
      const double end = config_.reverse_at_s.value_or(t_seconds);
      if (t_seconds <= end) return turned(t_seconds);
      return modulo_turn(2.0 * turned(end) - turned(t_seconds));  // mirrored at the turning point
    }
    case MotionKind::shuffled:
      return random_.uniform(k);
    case MotionKind::walk:
      return walked(k);
    case MotionKind::swing:
      return modulo_turn(config_.centre_turns +
                         config_.amplitude_turns *
                             std::sin(two_pi * product_modulo_turn(config_.swing_hz, t_seconds)));
    case MotionKind::profile:
      return ran(t_seconds);
    case MotionKind::recorded:
      break;
  }
  return 0.0;
}

void Motion::rewind() {
  walk_index_ = 0;
  walk_angle_ = 0.0;
}

// The integral of the speed from 0 to t.
double Motion::turned(double t_seconds) const {
  const double mean = product_modulo_turn(config_.frequency_hz, t_seconds);
  if (config_.kind == MotionKind::constant || config_.ripple_hz == 0.0) return mean;
  const double phase = two_pi * product_modulo_turn(config_.ripple_hz, t_seconds);
  const double depth =
      config_.frequency_hz * config_.ripple_amplitude / (two_pi * config_.ripple_hz);
  return modulo_turn(mean + depth * (1.0 - std::cos(phase)));
}

// The integral of straight lines: (speed + slope dt / 2) dt from the last point on.
double Motion::ran(double t_seconds) const {
  const std::vector<SpeedPoint>& points = config_.speeds;
  const auto later = [](double t, const SpeedPoint& point) { return t < point.time_s; };
  const auto next = std::upper_bound(points.begin(), points.end(), t_seconds, later);
  if (next == points.begin()) return 0.0;
  const SpeedPoint& from = *(next - 1);
  const double dt = t_seconds - from.time_s;
  const double slope =
      next == points.end() ? 0.0 : (next->speed_hz - from.speed_hz) / (next->time_s - from.time_s);
  const auto index = static_cast<std::size_t>(next - points.begin()) - 1;
  return modulo_turn(at_points_[index] + product_modulo_turn(from.speed_hz + slope * dt / 2, dt));
}

double Motion::walked(uint64_t k) {
  if (k < walk_index_) rewind();
  for (; walk_index_ < k; ++walk_index_) {
    const double step = config_.step_turns * random_.gaussian(walk_index_);
    walk_angle_ = modulo_turn(walk_angle_ + step);
  }
  return walk_angle_;
}

}  // namespace capsoc::sensor
