// Signals with known parameters.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/random.h"
#include "identification/calibration.h"
#include "identification/samples.h"

namespace capsoc::identification {

/// Table 1 of the CSFN paper.
constexpr Parameters table_1 = {0.3428, 0.2537, 0.0485, -0.0224, 0.9032};

struct TestSignal {
  Eigen::ArrayXd u, v;
};

/// Samples at random angles, Eq (3), with uniform noise of the given standard deviation.
inline TestSignal make_signal(const Parameters& p, Eigen::Index count, uint64_t seed,
                              double noise = 0, double turns = 1) {
  Random random(seed);
  TestSignal signal{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  const double width = noise * std::sqrt(12.0);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double theta = 2 * pi * turns * random.uniform();
    signal.u[i] = p.a1 * std::sin(theta) + p.b1;
    signal.v[i] = p.a2 * std::cos(theta + p.beta) + p.b2;
    if (noise > 0) signal.u[i] += width * (random.uniform() - 0.5);
    if (noise > 0) signal.v[i] += width * (random.uniform() - 0.5);
  }
  return signal;
}

enum class Angles { random, even_shuffled, constant_speed };

/// Samples with harmonics; `clean_u`, `clean_v` without the noise (normal, standard deviation
/// `noise`), `theta` their angles. constant_speed: 7.3 turns in order of time.
struct HarmonicSignal {
  Samples samples;
  Eigen::ArrayXd clean_u, clean_v, theta;
};

inline HarmonicSignal make_harmonic_signal(const SignalModel& model, Eigen::Index count,
                                           Angles angles, double noise, uint64_t seed) {
  Random random(seed);
  HarmonicSignal signal;
  for (Eigen::ArrayXd* array :
       {&signal.samples.u, &signal.samples.v, &signal.clean_u, &signal.clean_v, &signal.theta}) {
    array->resize(count);
  }
  Eigen::ArrayXd place = Eigen::ArrayXd::LinSpaced(count, 0, static_cast<double>(count - 1));
  place /= static_cast<double>(count);
  if (angles == Angles::even_shuffled) {
    for (Eigen::Index i = count - 1; i > 0; --i) std::swap(place[i], place[random.index(i + 1)]);
  }
  const auto normal = [&random] {
    double sum = -6;
    for (int k = 0; k < 12; ++k) sum += random.uniform();
    return sum;
  };
  for (Eigen::Index i = 0; i < count; ++i) {
    const double turns = angles == Angles::random           ? random.uniform()
                         : angles == Angles::constant_speed ? 7.3 * place[i]
                                                            : place[i];
    signal.theta[i] = 2 * pi * turns + 0.1;
    const Point at = point_at(model, signal.theta[i]);
    signal.clean_u[i] = at.u;
    signal.clean_v[i] = at.v;
    signal.samples.u[i] = at.u + noise * normal();
    signal.samples.v[i] = at.v + noise * normal();
  }
  return signal;
}

/// The largest of the five relative errors.
inline double relative_error(const Parameters& found, const Parameters& truth) {
  const double errors[] = {found.a1 / truth.a1 - 1, found.a2 / truth.a2 - 1,
                           found.b1 / truth.b1 - 1, found.b2 / truth.b2 - 1,
                           found.beta / truth.beta - 1};
  double largest = 0;
  for (double error : errors)
    largest = std::max(largest, std::isnan(error) ? 1e300 : std::abs(error));
  return largest;
}

/// The largest difference: amplitudes and offsets in units of the channel's amplitude, beta in rad.
inline double difference(const Parameters& one, const Parameters& other) {
  const double errors[] = {(one.a1 - other.a1) / other.a1, (one.a2 - other.a2) / other.a2,
                           (one.b1 - other.b1) / other.a1, (one.b2 - other.b2) / other.a2,
                           one.beta - other.beta};
  double largest = 0;
  for (double error : errors)
    largest = std::max(largest, std::isnan(error) ? 1e300 : std::abs(error));
  return largest;
}

}  // namespace capsoc::identification
