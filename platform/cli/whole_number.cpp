#include "cli/whole_number.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string>

namespace capsoc::cli {
namespace {

template <typename Number, typename... Form>
bool read(const std::string& text, std::size_t from, Number& value, Form... form) {
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data() + from, end, value, form...);
  return error == std::errc() && last == end;
}

}  // namespace

CLI::Validator whole_number(uint64_t least, uint64_t greatest) {
  const auto check = [least, greatest](std::string& text) -> std::string {
    const bool hexadecimal = text.rfind("0x", 0) == 0;
    uint64_t value = 0;
    if (!read(text, hexadecimal ? 2 : 0, value, hexadecimal ? 16 : 10) || value < least ||
        value > greatest)
      return fmt::format("'{}' is no whole number from {} to {}", text, least, greatest);
    text = std::to_string(value);
    return {};
  };
  return CLI::Validator(check, fmt::format("INT in [{} - {}]", least, greatest));
}

CLI::Validator real_number(double least, double greatest) {
  const auto check = [least, greatest](std::string& text) -> std::string {
    double value = 0;
    if (!read(text, 0, value) || !std::isfinite(value) || value < least || value > greatest)
      return fmt::format("'{}' is no number from {:g} to {:g}", text, least, greatest);
    return {};
  };
  return CLI::Validator(check, fmt::format("FLOAT in [{:g} - {:g}]", least, greatest));
}

CLI::Validator not_empty() {
  return CLI::Validator(
      [](std::string& text) { return std::string(text.empty() ? "a file's name is missing" : ""); },
      "");
}

}  // namespace capsoc::cli
