// Text to number, for what users write.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

namespace capsoc {

/// All of the text as a finite decimal number ("0.5", "1e-3"); nothing for anything else.
inline std::optional<double> finite_number(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || last != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// All of the text as a whole number, decimal or 0x.., so that 010 is 10; nothing for anything
/// else.
inline std::optional<uint64_t> whole_number(std::string_view text) {
  const bool is_hexadecimal = text.substr(0, 2) == "0x";
  if (is_hexadecimal) text.remove_prefix(2);
  uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value, is_hexadecimal ? 16 : 10);
  if (error != std::errc() || last != end) return std::nullopt;
  return value;
}

}  // namespace capsoc
