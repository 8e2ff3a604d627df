// What a damaged file or a guest program holds must not reach a terminal as it is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace capsoc {

/// True for what is not seen or changes the order of the text around it, of two or three bytes: the
/// no-break space, the soft hyphen, zero-width characters, separators, bidirectional controls, the
/// byte order mark.
inline bool is_invisible(unsigned first, unsigned second, unsigned third) {
  if (first == 0xC2) return second <= 0xA0 || second == 0xAD;
  if (first == 0xE2 && second == 0x80)
    return (third >= 0x8B && third <= 0x8F) || (third >= 0xA8 && third <= 0xAE);
  if (first == 0xE2 && second == 0x81) return third >= 0xA0 && third <= 0xAF;
  return first == 0xEF && second == 0xBB && third == 0xBF;
}

/// The bytes of the character that begins here, 1 to 4; 0: it is no UTF-8 (Unicode 15, table 3-7),
/// a control character (C0, DEL, C1), or not seen.
inline std::size_t printable_character(std::string_view text) {
  const auto byte = [text](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const auto continues = [&byte](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80) return first >= 0x20 && first != 0x7F ? 1 : 0;
  if (first < 0xC2 || first > 0xF4 || !continues(1)) return 0;
  if (is_invisible(first, second, byte(2))) return 0;
  if (first < 0xE0) return 2;
  if (!continues(2)) return 0;
  if (first < 0xF0)
    return (first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ? 0 : 3;
  const bool outside = (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F);
  return outside || !continues(3) ? 0 : 4;
}

/// UTF-8 of at most `longest` bytes. The bytes of a control character, of one that is not seen, and
/// of what is no UTF-8 become '?'; a longer text is cut in front of a character, with "..." after
/// it.
inline std::string printable(std::string_view text, std::size_t longest = 40) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t size = printable_character(text.substr(at));
    if (out.size() + (size == 0 ? 1 : size) > longest) return out + "...";
    if (size == 0)
      out += '?';
    else
      out += text.substr(at, size);
    at += size == 0 ? 1 : size;
  }
  return out;
}

/// The same bytes without control characters (below 0x20, and 0x7F), which become '?': the name of
/// a file in whatever encoding it has, for a file of lines.
inline std::string without_controls(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return out;
}

}  // namespace capsoc
