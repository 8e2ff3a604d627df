#include "sensor/text.h"

#include <fmt/format.h>

#include <algorithm>

namespace capsoc::sensor {

std::string_view trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool is_one_of(std::string_view word, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* one) { return word == one; });
}

Error error_at(const std::string& file, unsigned long line, const std::string& message) {
  return Error{fmt::format("{}:{}: {}", file, line, message)};
}

}  // namespace capsoc::sensor
