// Lists in one text, as settings and options have them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace capsoc {

/// The parts between separators. An empty text has none; a separator at the end begins no further
/// part.
inline std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return parts;
}

}  // namespace capsoc
