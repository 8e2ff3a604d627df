#include "base/curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace capsoc {
namespace {

/// Those that a double holds exactly.
constexpr std::array<double, 23> powers_of_ten = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr int exact_digits = 15;  ///< whole numbers of these are below 2^53

}  // namespace

Thinner::Thinner(std::size_t buckets, std::size_t curves)
    : parts_(std::max<std::size_t>(buckets, 2)), curves_(curves), last_y_(curves) {}

void Thinner::begin_bucket() {
  if (buckets_.size() == 2 * parts_ * curves_) halve();
  for (const double y : last_y_) {
    const Point point = {last_x_, y, points_ - 1};
    buckets_.push_back({point, point, point});
  }
  room_ = width_ - 1;
}

void Thinner::halve() {
  for (std::size_t part = 0; part < parts_; ++part)
    for (std::size_t i = 0; i < curves_; ++i) {
      Bucket both = buckets_[2 * part * curves_ + i];
      const Bucket& later = buckets_[(2 * part + 1) * curves_ + i];
      both.take(later.least);
      both.take(later.greatest);
      buckets_[part * curves_ + i] = both;
    }
  buckets_.resize(parts_ * curves_);
  width_ *= 2;
}

void Thinner::Point::visit(Archive& archive) {
  archive("x", x);
  archive("y", y);
  archive("at", at);
}

void Thinner::Bucket::visit(Archive& archive) {
  archive("first", first);
  archive("least", least);
  archive("greatest", greatest);
}

void Thinner::visit(Archive& archive) {
  archive("width", width_);
  archive("room", room_);
  archive("points", points_);
  archive("last_x", last_x_);
  archive("last_y", last_y_);
  archive("buckets", buckets_);
  const bool fits = last_y_.size() == curves_ && buckets_.size() % curves_ == 0 && width_ != 0 &&
                    (!buckets_.empty() || (points_ == 0 && room_ == 0));
  if (archive.loading() && !fits) archive.refuse("is of other curves");
}

Curve Thinner::curve(std::size_t number) const {
  Curve curve;
  const std::size_t count = buckets_.size() / curves_;
  const auto bucket = [&](std::size_t i) -> const Bucket& {
    return buckets_[i * curves_ + number];
  };
  if (width_ == 1) {
    for (std::size_t i = 0; i < count; ++i) curve.add(bucket(i).first.x, bucket(i).first.y);
    return curve;
  }
  const auto add = [&](const Point& point) {
    if (point.at != 0 && point.at + 1 != points_) curve.add(point.x, point.y);
  };
  // The ends are their own points, which takes one part's two.
  const std::size_t parts = parts_ - 1;
  const auto begin = [&](std::size_t part) { return count * part / parts; };
  curve.add(bucket(0).first.x, bucket(0).first.y);
  for (std::size_t part = 0; part < parts; ++part) {
    Bucket all = bucket(begin(part));
    for (std::size_t i = begin(part) + 1; i < begin(part + 1); ++i) {
      all.take(bucket(i).least);
      all.take(bucket(i).greatest);
    }
    const bool falls = all.greatest.at < all.least.at;
    if (std::isnan(all.first.y)) add(all.first);
    if (std::isnan(all.least.y)) continue;
    add(falls ? all.greatest : all.least);
    if (all.least.at != all.greatest.at) add(falls ? all.least : all.greatest);
  }
  curve.add(last_x_, last_y_[number]);
  return curve;
}

Curve thinned(const Curve& curve, std::size_t buckets) {
  Thinner thinner(buckets);
  for (std::size_t i = 0; i < curve.x.size(); ++i) thinner.add(curve.x[i], curve.y[i]);
  return thinner.curve();
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
