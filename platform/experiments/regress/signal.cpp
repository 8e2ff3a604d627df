#include "regress/signal.h"

#include <cmath>

#include "base/constants.h"
#include "base/fixed.h"

namespace capsoc::regress {
namespace {

double magnitude(Random& random, double least, double most) {
  return std::exp(std::log(least) + random.uniform() * std::log(most / least));
}

}  // namespace

Signal::Signal(Random& random) {
  switch (random.below(12)) {
    case 0:
      kind_ = Kind::faint_sensor;
      break;
    case 1:
    case 2:
      kind_ = Kind::noise;
      break;
    case 3:
    case 4:
      kind_ = Kind::corners;
      break;
    case 5:
      kind_ = Kind::steps;
      break;
    case 6:
      kind_ = Kind::shuffled_sensor;
      break;
    default:
      kind_ = Kind::sensor;
  }
  const double least = kind_ == Kind::faint_sensor ? 1e-9 : 0.01;
  const double most = kind_ == Kind::faint_sensor ? 1e-3 : 1.1;  // beyond full scale it clips
  a1_ = magnitude(random, least, most);
  a2_ = magnitude(random, least, most);
  b1_ = (random.uniform() - 0.5) * 0.6;
  b2_ = (random.uniform() - 0.5) * 0.6;
  phi_ = random.uniform() * two_pi;
  beta_ = (random.uniform() - 0.5) * (random.chance(0.5) ? 0.5 : two_pi);
  const double speed = magnitude(random, 1e-6, 0.3);
  frequency_ = std::llround(std::ldexp(random.chance(0.5) ? speed : -speed, 48));
  ripple_ = random.chance(0.3) ? random.uniform() * 0.2 : 0;
  turns_ = random.uniform();
}

Sample Signal::sensor(double turns) const {
  const double u = a1_ * std::sin(turns * two_pi + phi_) + b1_;
  const double v = a2_ * std::cos(turns * two_pi + phi_ + beta_) + b2_;
  return {static_cast<uint32_t>(fixed::to_q31(u)), static_cast<uint32_t>(fixed::to_q31(v)),
          std::fabs(u) >= 1 || std::fabs(v) >= 1};
}

Sample Signal::next(Random& random) {
  switch (kind_) {
    case Kind::noise: {
      const uint64_t word = random.word();
      return {static_cast<uint32_t>(word), static_cast<uint32_t>(word >> 32), (word & 255) == 0};
    }
    case Kind::corners:
      return {corner32(random), corner32(random), random.chance(0.1)};
    case Kind::steps:
      if (random.chance(0.05)) held_ = {corner32(random), corner32(random), random.chance(0.1)};
      return held_;
    case Kind::shuffled_sensor:
      return sensor(random.uniform());
    default:
      turns_ += std::ldexp(static_cast<double>(frequency_), -48) *
                (1 + ripple_ * (random.uniform() - 0.5));
      turns_ -= std::floor(turns_);
      return sensor(turns_);
  }
}

}  // namespace capsoc::regress
