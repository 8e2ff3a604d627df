#include "loader/program_file.h"

#include <fmt/format.h>

#include <cstdlib>
#include <optional>

#include "support/input_file.h"

namespace capsoc::loader {
namespace {

constexpr uint64_t largest_file = 64U << 20U;  // more than all memories of the board

Result<std::string> contents(const std::string& path) {
  return read_input(path, {"name a file to load", largest_file});
}

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

/// The bytes of a line behind its colon, or nothing.
std::optional<std::vector<uint8_t>> record_bytes(const std::string& line) {
  if (line.size() % 2 == 0) return std::nullopt;
  std::vector<uint8_t> bytes;
  for (std::size_t i = 1; i < line.size(); i += 2) {
    const int high = digit(line[i]), low = digit(line[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes.push_back(static_cast<uint8_t>(high * 16 + low));
  }
  return bytes;
}

/// Reads records into an image.
class HexReader {
 public:
  explicit HexReader(std::string path) { image_.path = std::move(path); }

  /// What is wrong with a line, or null.
  const char* line(const std::string& text) {
    if (text.empty()) return nullptr;
    if (text[0] != ':') return "does not begin with a colon";
    const auto bytes = record_bytes(text);
    if (!bytes || bytes->size() < 5) return "is no record of whole bytes";
    if (bytes->size() != std::size_t{(*bytes)[0]} + 5) return "has a wrong length";
    uint8_t sum = 0;
    for (const uint8_t b : *bytes) sum = static_cast<uint8_t>(sum + b);
    if (sum != 0) return "has a wrong checksum";
    if (ended_) return "stands behind the end record";
    const uint32_t offset = uint32_t{(*bytes)[1]} << 8U | (*bytes)[2];
    return record((*bytes)[3], offset, {bytes->begin() + 4, bytes->end() - 1});
  }
  bool ended() const { return ended_; }
  ElfImage take() { return std::move(image_); }

 private:
  const char* record(uint8_t type, uint32_t offset, const std::vector<uint8_t>& data) {
    uint32_t value = 0;
    for (const uint8_t b : data) value = value << 8U | b;
    switch (type) {
      case 0:
        return append(offset, data);
      case 1:
        ended_ = true;
        return data.empty() ? nullptr : "is an end record with data";
      case 2:
      case 4:
        if (data.size() != 2) return "is an address record of the wrong length";
        base_ = type == 2 ? value << 4U : value << 16U;
        return nullptr;
      case 3:  // CS:IP of an 8086
        return data.size() == 4 ? nullptr : "is a start record of the wrong length";
      case 5:
        if (data.size() != 4) return "is a start record of the wrong length";
        image_.entry = value;
        return nullptr;
      default:
        return "has a type that Intel HEX does not know";
    }
  }
  const char* append(uint32_t offset, const std::vector<uint8_t>& data) {
    if (data.empty()) return nullptr;
    const uint64_t address = uint64_t{base_} + offset;
    if (address + data.size() > uint64_t{1} << 32U) return "leaves the address space";
    auto& segments = image_.segments;
    const bool goes_on =
        !segments.empty() &&
        uint64_t{segments.back().address} + segments.back().bytes.size() == address;
    if (!goes_on) segments.push_back({static_cast<uint32_t>(address), {}, 0});
    Segment& segment = segments.back();
    segment.bytes.insert(segment.bytes.end(), data.begin(), data.end());
    segment.memory_size = static_cast<uint32_t>(segment.bytes.size());
    return nullptr;
  }

  ElfImage image_;
  uint32_t base_ = 0;
  bool ended_ = false;
};

}  // namespace

Result<ElfImage> load_hex(const std::string& path) {
  const auto text = contents(path);
  if (!text) return Error{text.error()};
  return parse_hex(path, text.value());
}

Result<ElfImage> parse_hex(const std::string& path, const std::string& text) {
  HexReader reader(path);
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = text.find('\n', at);
    if (end == std::string::npos) end = text.size();
    std::string line = text.substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    at = end + 1;
    ++number;
    if (const char* fault = reader.line(line))
      return Error{fmt::format("{}:{}: the line {}; write it anew with objcopy -O ihex", path,
                               number, fault)};
  }
  if (!reader.ended())
    return Error{fmt::format("{}: has no end record; the file is cut short", path)};
  ElfImage image = reader.take();
  if (image.segments.empty()) return Error{fmt::format("{}: has nothing to load", path)};
  return image;
}

Result<ElfImage> load_program(const std::string& path) {
  auto bytes = read_program(path);
  if (!bytes) return Error{bytes.error()};
  const bool hex = bytes.value().front() == ':';
  return hex ? parse_hex(path, bytes.value()) : parse_elf(path, std::move(bytes.value()));
}

Result<ElfImage> load_at(const std::string& place) {
  const std::size_t at = place.rfind('@');
  if (at == std::string::npos) return load_program(place);
  const std::string path = place.substr(0, at), number = place.substr(at + 1);
  char* end = nullptr;
  const unsigned long long address = std::strtoull(number.c_str(), &end, 0);
  if (number.empty() || digit(number[0]) < 0 || *end != '\0' || address > 0xFFFFFFFF)
    return Error{
        fmt::format("--load {}: '{}' is no address; write FILE@0x21000000", place, number)};
  auto bytes = contents(path);
  if (!bytes) return Error{bytes.error()};
  const uint64_t size = bytes.value().size();
  if (address + size > uint64_t{1} << 32U)
    return Error{fmt::format("{}: does not fit behind {:#x}", path, address)};
  ElfImage image;
  image.path = path;
  image.segments.push_back({static_cast<uint32_t>(address),
                            {bytes.value().begin(), bytes.value().end()},
                            static_cast<uint32_t>(size)});
  return image;
}

}  // namespace capsoc::loader
