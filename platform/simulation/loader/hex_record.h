// Lines of hexadecimal bytes, which Intel HEX and S-records have in common.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_file.h"
#include "loader/elf_image.h"

namespace capsoc::loader {

/// The value of a hexadecimal digit; -1: it is none.
inline int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

/// The bytes of pairs of digits, or nothing.
inline std::optional<std::vector<uint8_t>> hex_bytes(std::string_view digits) {
  if (digits.size() % 2 != 0) return std::nullopt;
  std::vector<uint8_t> bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const int high = hex_digit(digits[i]), low = hex_digit(digits[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes.push_back(static_cast<uint8_t>(high * 16 + low));
  }
  return bytes;
}

/// Adds bytes at an address, to the last segment where they continue it. What is wrong, or null.
inline const char* append_data(ElfImage& image, uint64_t address,
                               const std::vector<uint8_t>& data) {
  if (data.empty()) return nullptr;
  if (address + data.size() > uint64_t{1} << 32U) return "leaves the address space";
  auto& segments = image.segments;
  const bool continues =
      !segments.empty() &&
      uint64_t{segments.back().address} + segments.back().bytes.size() == address;
  if (!continues) segments.push_back({static_cast<uint32_t>(address), {}, 0});
  Segment& segment = segments.back();
  segment.bytes.insert(segment.bytes.end(), data.begin(), data.end());
  segment.memory_size = static_cast<uint32_t>(segment.bytes.size());
  return nullptr;
}

/// Reads a file line by line. `Reader`: constructed with the path; line(text) says what is wrong
/// with a line without its end, or null; ended() is true after the end record; take() gives the
/// image. `format`: of objcopy, for the sentence of an error.
template <typename Reader>
Result<ElfImage> read_records(const std::string& path, std::string_view text, const char* format) {
  Reader reader(path);
  text = without_byte_order_mark(text);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (const char* fault = line.empty() ? nullptr : reader.line(line))
      return Error{fmt::format("{}:{}: the line {}; write it again with objcopy -O {}", path,
                               number, fault, format)};
  }
  if (!reader.ended())
    return Error{fmt::format("{}: has no end record; the file is cut short", path)};
  ElfImage image = reader.take();
  if (image.segments.empty()) return Error{fmt::format("{}: has nothing to load", path)};
  return image;
}

}  // namespace capsoc::loader
