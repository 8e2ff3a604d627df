#include "report/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace capsoc::report {

bool is_number(const std::string& text) {
  if (text.empty()) return false;
  if (text == "-") return true;  // none, in a column of numbers
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return *end == '\0';
}

std::string shortened(const std::string& text) {
  constexpr int many = 6;
  const std::size_t mantissa = std::min(text.find_first_of("eE"), text.size());
  const std::size_t first = text.find_first_of("123456789");
  if (first == std::string::npos || text.find('.') >= mantissa) return text;
  const auto digits =
      std::count_if(text.begin() + static_cast<std::ptrdiff_t>(std::min(first, mantissa)),
                    text.begin() + static_cast<std::ptrdiff_t>(mantissa),
                    [](char c) { return c >= '0' && c <= '9'; });
  return digits <= many ? text : fmt::format("{:.5g}", std::strtod(text.c_str(), nullptr));
}

std::string three_digits(double value) {
  constexpr double whole = 100, million = 1e6, large = 1e12;
  const double size = std::abs(value);
  if (size < whole || size >= large) return fmt::format("{:.3g}", value);
  if (size < million) return fmt::format("{:.0f}", value);
  return fmt::format("{:.{}f} million", value / million, size < 1e7 ? 2 : size < 1e8 ? 1 : 0);
}

std::string percent(double share) {
  return fmt::format("{:.2f} %", 100 * share);
}

std::string counted(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

namespace {

/// Without an exponent from 1 to a million.
std::string with_digits(double value, int digits) {
  constexpr double million = 1e6;
  const double size = std::abs(value);
  if (size >= 1 && size < million)
    digits = std::max(digits, 1 + static_cast<int>(std::log10(size)));
  return fmt::format("{:.{}g}", value, digits);
}

}  // namespace

std::pair<std::string, std::string> told_apart(double a, double b, int digits) {
  constexpr int all = 17;
  std::pair<std::string, std::string> texts;
  for (; digits <= all; ++digits) {
    texts = {with_digits(a, digits), with_digits(b, digits)};
    const double shown =
        std::strtod(texts.second.c_str(), nullptr) - std::strtod(texts.first.c_str(), nullptr);
    if (std::abs(shown - (b - a)) <= std::abs(b - a) / 2) break;
  }
  return texts;
}

}  // namespace capsoc::report
