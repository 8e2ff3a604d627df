#include "sensor/sample_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sensor/text.h"

namespace capsoc::sensor {
namespace {

constexpr double beyond = 1.1;  // above, it is another unit and no gain that is a little too high
constexpr double most_outside = 0.01;

UnitGuess unsigned_counts(double most) {
  int bits = 8;
  while (std::ldexp(1.0, bits) <= most && bits < 32) bits += 2;
  const double half = std::ldexp(1.0, bits - 1);
  return {fmt::format("{}-bit counts", bits), half, half};
}

UnitGuess signed_counts(double largest) {
  int bits = 8;
  while (std::ldexp(1.0, bits - 1) < largest && bits < 32) bits += 2;
  return {fmt::format("signed {}-bit counts", bits), std::ldexp(1.0, bits - 1), 0};
}

/// Volts of a sensor at a supply, or about zero; `scale` is how many of the unit a volt has.
UnitGuess volts(double least, double most, double scale, const char* name) {
  const double middle = (least + most) / 2, half = (most - least) / 2;
  if (std::fabs(middle) < half / 2 || least < 0) {
    const double largest = std::max(std::fabs(least), std::fabs(most)) / scale;
    for (const double range : {1.0, 1.25, 2.0, 2.5, 5.0, 10.0, 12.0, 15.0, 24.0, 30.0})
      if (range >= largest) return {name, range * scale, 0};
    return {name, std::ceil(largest) * scale, 0};
  }
  // Signals of a supply lie about its half.
  double best = 0;
  for (const double supply : {1.8, 2.5, 3.0, 3.3, 5.0, 10.0, 12.0, 15.0, 24.0})
    if (supply * scale >= most && (best == 0 || std::fabs(std::log(supply * scale / 2 / middle)) <
                                                    std::fabs(std::log(best / 2 / middle))))
      best = supply * scale;
  if (best == 0) best = std::ceil(most / scale) * scale;
  return {fmt::format("{} of a {:g} V supply", name, best / scale), best / 2, best / 2};
}

}  // namespace

void ValueRange::take(double value) {
  least = count == 0 ? value : std::min(least, value);
  most = count == 0 ? value : std::max(most, value);
  whole = whole && value == std::floor(value);
  if (value > beyond || value < -beyond) ++outside;
  ++count;
}

bool ValueRange::outside_full_scale() const {
  return static_cast<double>(outside) > most_outside * static_cast<double>(count);
}

UnitGuess guess_unit(const ValueRange& range, const std::string& unit) {
  const double least = range.least, most = range.most;
  const double largest = std::max(std::fabs(least), std::fabs(most));
  if (is_one_of(unit, {"%", "percent", "pct"})) {
    if (least >= 0 && most <= 100) return {"percent", 50, 50};
    return {"percent", std::max(100.0, std::ceil(largest)), 0};
  }
  if (is_one_of(unit, {"v", "volt", "volts"})) return volts(least, most, 1, "volts");
  if (is_one_of(unit, {"mv", "millivolt", "millivolts"}))
    return volts(least, most, 1e3, "millivolts");
  if (largest <= 1) return {"full scale", 1, 0};
  // Counts of a real converter; above 2^32 no whole number is one.
  if (range.whole && largest > 32 && largest < std::ldexp(1.0, least < 0 ? 31 : 32))
    return least < 0 ? signed_counts(largest) : unsigned_counts(most);
  if (largest <= 30) return volts(least, most, 1, "volts");
  if (largest <= 100) {
    if (least >= 0) return {"percent", 50, 50};
    return {"percent", 100, 0};
  }
  if (largest <= 30e3) return volts(least, most, 1e3, "millivolts");
  return {"another unit", std::ceil(largest), 0};
}

std::optional<double> grid_step(const SampleColumn& channel) {
  constexpr std::size_t looked_at = 20'000;
  constexpr double most_steps = 0x1p24, off = 0.05;
  std::vector<double> values;
  const std::size_t stride = channel.size() / looked_at + 1;
  values.reserve(channel.size() / stride + 1);
  for (std::size_t k = 0; k < channel.size(); k += stride) values.push_back(channel[k]);
  std::sort(values.begin(), values.end());
  if (values.empty()) return std::nullopt;
  const double span = values.back() - values.front();
  // What differs by less was calculated and is the same value.
  const double same = span * 1e-12;
  values.erase(
      std::unique(values.begin(), values.end(), [&](double a, double b) { return b - a <= same; }),
      values.end());
  if (values.size() < 16) return std::nullopt;
  double step = span;
  for (std::size_t i = 1; i < values.size(); ++i) step = std::min(step, values[i] - values[i - 1]);
  if (span / step > most_steps) return std::nullopt;
  // A smallest distance is off by the digits that values are written in; every larger one tells
  // the step better.
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double distance = values[i] - values.front();
    const double steps = std::round(distance / step);
    if (std::fabs(distance - steps * step) > 4 * off * step) return std::nullopt;
    step = distance / steps;
  }
  bool on_grid = true;
  channel.for_each([&](double value) {
    const double steps = (value - values.front()) / step;
    on_grid = on_grid && std::fabs(steps - std::nearbyint(steps)) <= off;
  });
  return on_grid ? std::make_optional(step) : std::nullopt;
}

std::optional<double> common_step(const SampleColumn& u, const SampleColumn& v) {
  const auto one = grid_step(u);
  if (!one) return std::nullopt;
  const auto other = grid_step(v);
  if (!other || std::fabs(*one - *other) > 1e-2 * *one) return std::nullopt;
  return (*one + *other) / 2;
}

}  // namespace capsoc::sensor
