#include "report/scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace capsoc::report {

bool Scale::holds(double value) const {
  return std::isfinite(value) && (!log_ || value != 0);
}

void Scale::take(double value) {
  if (!holds(value)) return;
  least_ = std::min(least_, shown(value));
  greatest_ = std::max(greatest_, shown(value));
}

void Scale::close(double margin, bool from_zero) {
  if (!(least_ <= greatest_)) least_ = 0, greatest_ = 1;
  const bool at_zero = from_zero && least_ >= 0;
  // Halved before they are subtracted: the range of any two doubles is finite then.
  double half = greatest_ / 2 - least_ / 2;
  if (half == 0) half = std::max(std::abs(least_) / 10, 1e-300);
  const double middle = greatest_ / 2 + least_ / 2;
  half = std::min(half * (1 + margin), std::numeric_limits<double>::max() / 4);
  least_ = at_zero ? 0 : middle - half;
  greatest_ = middle + half;
}

double Scale::part(double value) const {
  return part_of_shown(shown(value));
}

double Scale::part_of_shown(double value) const {
  constexpr double far = 1000;
  const double part = (value / 2 - least_ / 2) / (greatest_ / 2 - least_ / 2);
  return std::clamp(std::isfinite(part) ? part : 0.0, -far, far);
}

double Scale::shown(double value) const {
  return log_ ? std::log10(std::abs(value)) : value;
}

std::vector<double> Scale::round_numbers(double least, double greatest) const {
  std::vector<double> all;
  const double range = greatest - least;
  if (!(range > 0) || !std::isfinite(range)) return all;
  double step = std::pow(10, std::floor(std::log10(range / 5)));
  for (const double factor : {2.0, 2.5, 2.0})
    if (range / step > 8) step *= factor;
  if (!(step > 0)) return all;
  const double first = std::ceil(least / step);
  for (int i = 0; i < 12; ++i) {
    const double at = (first + i) * step;
    if (!(at <= greatest)) break;
    all.push_back(std::abs(at) < step * 1e-6 ? 0.0 : at);
  }
  return all;
}

std::vector<Scale::Tick> Scale::ticks() const {
  std::vector<Tick> all;
  const double range = greatest_ - least_;
  constexpr double few_decades = 2, most_ticks = 8;
  if (log_ && range >= few_decades && std::isfinite(range)) {
    const double step = std::max(1.0, std::ceil(range / most_ticks));
    for (int i = static_cast<int>(std::ceil(least_ / step)); i * step <= greatest_; ++i)
      all.push_back({part_of_shown(i * step), fmt::format("1e{:g}", i * step)});
    return all;
  }
  const auto value = [&](double end) { return log_ ? std::pow(10, end) : end; };
  for (const double at : round_numbers(value(least_), value(greatest_)))
    if (holds(at)) all.push_back({part(at), tick_label(at)});
  return all;
}

std::string tick_label(double value) {
  std::string text = fmt::format("{:.6g}", value);
  const std::size_t exponent = text.find('e');
  if (exponent == std::string::npos) return text;
  return fmt::format("{}e{}", text.substr(0, exponent),
                     std::strtol(text.c_str() + exponent + 1, nullptr, 10));
}

}  // namespace capsoc::report
