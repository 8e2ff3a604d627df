// What a damaged file or a guest program holds must not reach a terminal as it is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace capsoc {

/// Bytes outside 0x20 .. 0x7E become '?'; more than `longest` characters are cut with "...".
inline std::string printable(std::string_view text, std::size_t longest = 40) {
  std::string out(text.substr(0, longest));
  for (char& c : out) {
    if (c < 0x20 || c > 0x7E) c = '?';
  }
  if (text.size() > longest) out += "...";
  return out;
}

}  // namespace capsoc
