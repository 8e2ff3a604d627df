#include "support/curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace capsoc {
namespace {

/// The points [from, to) that stay, in order.
void thin_bucket(const Curve& curve, std::size_t from, std::size_t to, Curve& kept) {
  if (std::isnan(curve.y[from])) kept.add(curve.x[from], curve.y[from]);
  std::size_t least = to, greatest = to;
  for (std::size_t i = from; i < to; ++i) {
    if (std::isnan(curve.y[i])) continue;
    if (least == to || curve.y[i] < curve.y[least]) least = i;
    if (greatest == to || curve.y[i] > curve.y[greatest]) greatest = i;
  }
  if (least == to) return;
  const auto [first, second] = std::minmax(least, greatest);
  kept.add(curve.x[first], curve.y[first]);
  if (second != first) kept.add(curve.x[second], curve.y[second]);
}

}  // namespace

Curve thinned(const Curve& curve, std::size_t buckets) {
  const std::size_t count = curve.x.size();
  if (count <= 2 * buckets || buckets < 2) return curve;
  Curve kept;
  kept.x.reserve(2 * buckets);
  kept.y.reserve(2 * buckets);
  kept.add(curve.x.front(), curve.y.front());
  // The ends are points of their own, which takes one bucket's two.
  const std::size_t inner = count - 2, parts = buckets - 1;
  for (std::size_t part = 0; part < parts; ++part)
    thin_bucket(curve, 1 + inner * part / parts, 1 + inner * (part + 1) / parts, kept);
  kept.add(curve.x.back(), curve.y.back());
  return kept;
}

double rounded(double value, int digits) {
  if (!std::isfinite(value)) return value;
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
