#include "support/curve.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace capsoc {
namespace {

/// Those that a double holds exactly.
constexpr std::array<double, 23> powers_of_ten = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr int exact_digits = 15;  ///< whole numbers of these are below 2^53

}  // namespace

Thinner::Thinner(std::size_t points, std::size_t buckets)
    : points_(points),
      keeps_all_(points <= 2 * buckets || buckets < 2),
      inner_(keeps_all_ ? 0 : points - 2),
      parts_(keeps_all_ ? 0 : buckets - 1) {
  kept_.x.reserve(keeps_all_ ? points : 2 * buckets);
  kept_.y.reserve(kept_.x.capacity());
}

void Thinner::begin_bucket(Point point) {
  end_bucket();
  // The ends are points of their own, which takes one bucket's two.
  const bool is_end = at_ == 0 || at_ + 1 == points_;
  if (is_end || std::isnan(point.y)) kept_.add(point.x, point.y);
  if (!is_end) take(point);
  next_ = at_ + 1 == points_ ? points_ : 1 + inner_ * part_++ / parts_;
}

void Thinner::end_bucket() {
  if (is_empty_) return;
  is_empty_ = true;
  const bool falls = greatest_.at < least_.at;
  const Point &first = falls ? greatest_ : least_, &second = falls ? least_ : greatest_;
  kept_.add(first.x, first.y);
  if (second.at != first.at) kept_.add(second.x, second.y);
}

Curve thinned(const Curve& curve, std::size_t buckets) {
  Thinner thinner(curve.x.size(), buckets);
  for (std::size_t i = 0; i < curve.x.size(); ++i) thinner.add(curve.x[i], curve.y[i]);
  return std::move(thinner).curve();
}

double rounded(double value, int digits) {
  if (!std::isfinite(value) || value == 0) return value;
  // A whole number below 2^53 by an exact power of ten: the quotient is the double nearest to that
  // decimal, a tenth of the time that its text takes.
  const int shift = digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (digits <= exact_digits && shift >= 0 && shift < static_cast<int>(powers_of_ten.size())) {
    const double power = powers_of_ten[static_cast<std::size_t>(shift)];
    return std::nearbyint(value * power) / power;
  }
  std::array<char, 40> text{};
  *fmt::format_to_n(text.data(), text.size() - 1, "{:.{}g}", value, digits).out = '\0';
  return std::strtod(text.data(), nullptr);
}

nlohmann::ordered_json to_json(const Curves& curves) {
  nlohmann::ordered_json j = nlohmann::ordered_json::object();
  for (const auto& [name, curve] : curves) j[name] = {{"x", curve.x}, {"y", curve.y}};
  return j;
}

}  // namespace capsoc
