#include "campaign/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/random.h"
#include "identification/distributions.h"

namespace capsoc::campaign {
namespace {

/// The same on every host: FNV-1a.
uint64_t stream_of(const std::string& name) {
  uint64_t hash = 0xCBF29CE484222325u;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  return hash;
}

/// Of the normal distribution.
double share_below(double x) {
  return std::erfc(-x / std::sqrt(2.0)) / 2;
}

double normal_at(double quantile) {
  // Beyond 8.2 there is less than the last place of 1.
  constexpr double largest = 8.2;
  if (quantile <= share_below(-largest)) return -largest;
  if (quantile >= share_below(largest)) return largest;
  const double x = identification::normal_quantile(std::fabs(2 * quantile - 1));
  return quantile < 0.5 ? -x : x;
}

std::string number_text(double value) {
  return fmt::format("{}", value);
}

/// Exact where the step is a whole number: a product before the division.
double in_equal_steps(double a, double b, uint64_t index, uint64_t count) {
  if (count < 2 || index == 0) return a;
  if (index == count - 1) return b;
  return a + (b - a) * static_cast<double>(index) / static_cast<double>(count - 1);
}

}  // namespace

uint64_t draw_word(uint64_t seed, const std::string& name, uint64_t index) {
  return RandomSequence(seed, stream_of(name)).word(index);
}

double draw(uint64_t seed, const std::string& name, uint64_t index) {
  return RandomSequence(seed, stream_of(name)).uniform(index);
}

std::string draw_seed(uint64_t seed, const std::string& name, uint64_t index) {
  return fmt::format("{}", draw_word(seed, name, index) >> 1);
}

std::vector<uint32_t> draw_order(uint64_t seed, const std::string& name, uint32_t count) {
  std::vector<uint32_t> order(count);
  for (uint32_t i = 0; i < count; ++i) order[i] = i;
  for (uint32_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[draw_word(seed, name + " order", i) % i]);
  return order;
}

std::string Axis::value(uint64_t index, uint64_t seed) const {
  const double share =
      count > 1 ? static_cast<double>(index) / static_cast<double>(count - 1) : 0.0;
  switch (kind) {
    case Kind::list:
      return values[index];
    case Kind::range:
      return number_text(in_equal_steps(a, b, index, count));
    case Kind::log_range:
      return number_text(index == 0           ? a
                         : index == count - 1 ? b
                                              : a * std::exp(std::log(b / a) * share));
    default:
      return at_quantile(draw(seed, path, index), seed, index);
  }
}

std::string Axis::at_quantile(double quantile, uint64_t seed, uint64_t index) const {
  const auto part = [quantile](double parts) { return std::floor(quantile * parts); };
  switch (kind) {
    case Kind::list:
    case Kind::range:
    case Kind::log_range:
      return value(static_cast<uint64_t>(part(static_cast<double>(count))), seed);
    case Kind::uniform:
      return number_text(a + (b - a) * quantile);
    case Kind::log_uniform:
      return number_text(a * std::exp(std::log(b / a) * quantile));
    case Kind::normal: {
      const double below = share_below((least - a) / b), to = share_below((greatest - a) / b);
      return number_text(
          std::clamp(a + b * normal_at(below + (to - below) * quantile), least, greatest));
    }
    case Kind::integers:
      return fmt::format("{}", static_cast<int64_t>(a + part(b - a + 1)));
    case Kind::seeds:
      return draw_seed(seed, path, index);
  }
  return "";
}

}  // namespace capsoc::campaign
