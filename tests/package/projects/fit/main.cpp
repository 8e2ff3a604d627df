// The identification of a sensor from its samples alone, without a simulation.
#include <cmath>
#include <cstdio>

#include "identification/identify.h"

int main() {
  constexpr int count = 4000;
  const double turn = 2 * std::acos(-1.0);
  capsoc::identification::Samples samples{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  for (int k = 0; k < count; ++k) {
    const double theta = turn * k * 7 / count;
    samples.u[k] = 0.6 * std::sin(theta) + 0.1;
    samples.v[k] = 0.7 * std::cos(theta + 0.2) - 0.05;
  }
  const auto found = capsoc::identification::identify(samples);
  if (!found) {
    std::printf("%s\n", found.error().c_str());
    return 1;
  }
  const auto& p = found.value().parameters;
  std::printf("a1 %.4f, a2 %.4f, b1 %.4f, b2 %.4f, beta %.4f\n", p.a1, p.a2, p.b1, p.b2, p.beta);
  return 0;
}
