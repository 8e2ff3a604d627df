#include "identification/uncertainty.h"

#include <algorithm>
#include <cmath>

namespace capsoc::identification {
namespace {

/// One sample seen by the network: Y, and its gradient by x and y over Y.
struct Seen {
  double x, y, norm, by_x, by_y;
};

/// e^(i angle); std::complex checks every product for infinities.
struct Direction {
  double real, imaginary;
};

Direction operator*(Direction a, Direction b) {
  return {a.real * b.real - a.imaginary * b.imaginary, a.real * b.imaginary + a.imaginary * b.real};
}

class View {
 public:
  explicit View(const Parameters& parameters)
      : p_(parameters), sine_(std::sin(p_.beta)), cosine_(std::cos(p_.beta)) {
    a_ = 1 / (cosine_ * cosine_);  // Eq (6): Y^2 cos^2(beta) = x^2 + y^2 + 2 sin(beta) xy
    b_ = sine_ * a_;
  }

  Seen at(double u, double v) const {
    Seen seen{};
    seen.x = (u - p_.b1) / p_.a1;
    seen.y = (v - p_.b2) / p_.a2;
    const double half_x = a_ * seen.x + b_ * seen.y;
    const double half_y = a_ * seen.y + b_ * seen.x;
    seen.norm = std::sqrt(std::max(seen.x * half_x + seen.y * half_y, 1e-300));
    seen.by_x = half_x / seen.norm;
    seen.by_y = half_y / seen.norm;
    return seen;
  }

  double slope(const Seen& s) const {
    const double by_u = s.by_x / p_.a1;
    const double by_v = s.by_y / p_.a2;
    return std::sqrt(by_u * by_u + by_v * by_v);
  }

  /// e^(i theta) of Eq (4). Y cos(beta) is the length of Eq (4)'s sine and cosine times cos(beta).
  Direction direction(const Seen& s) const {
    return {(s.y + s.x * sine_) / (cosine_ * s.norm), s.x / s.norm};
  }

 private:
  const Parameters& p_;
  double sine_, cosine_;
  double a_ = 1, b_ = 0;
};

}  // namespace

Scatter scatter_of(const Channel& u, const Channel& v, const Parameters& parameters) {
  const View view(parameters);
  Scatter scatter;
  std::array<Direction, 5> order{};
  Direction steps{0, 0};
  Direction last{0, 0};
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const Seen seen = view.at(u[i], v[i]);
    const double residual = 1 - seen.norm;
    const double distance = residual / std::max(view.slope(seen), 1e-300);
    scatter.rms += residual * residual;
    scatter.noise += distance * distance;
    scatter.largest = std::max(scatter.largest, std::abs(residual));
    const Direction direction = view.direction(seen);
    Direction turned{residual, 0};
    for (auto& sum : order) {
      sum.real += turned.real;
      sum.imaginary += turned.imaginary;
      turned = turned * direction;
    }
    const Direction step = direction * Direction{last.real, -last.imaginary};
    steps.real += step.real;
    steps.imaginary += step.imaginary;
    last = direction;
  }
  const auto count = static_cast<double>(u.size());
  scatter.rms = std::sqrt(scatter.rms / count);
  scatter.noise = std::sqrt(scatter.noise / count);
  for (std::size_t m = 0; m < order.size(); ++m) {
    scatter.order[m] = std::hypot(order[m].real, order[m].imaginary) / count;
  }
  scatter.step_length = std::hypot(steps.real, steps.imaginary) / std::max(count - 1, 1.0);
  scatter.step = std::atan2(steps.imaginary, steps.real);
  return scatter;
}

}  // namespace capsoc::identification
