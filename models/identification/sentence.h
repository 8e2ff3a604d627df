// Sentences with figures in them, for reasons and checks.
#pragma once

#include <cstdio>
#include <string>

namespace capsoc::identification {

/// `format` is a literal of printf's with one or two floating-point conversions; the result has at
/// most 319 characters.
inline std::string text(const char* format, double one, double other = 0) {
  char buffer[320];
  // NOLINTNEXTLINE(clang-diagnostic-format-nonliteral): the formats are literals at every call
  std::snprintf(buffer, sizeof buffer, format, one, other);
  return buffer;
}

}  // namespace capsoc::identification
