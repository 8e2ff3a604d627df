// Text as XML has it.
#pragma once

#include <string>
#include <string_view>

namespace capsoc {

/// For contents and attributes. Control characters, which XML has no form for, become '?'.
inline std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        const bool printable = static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t';
        out += printable ? c : '?';
    }
  }
  return out;
}

}  // namespace capsoc
