// Intel HEX (Intel, "Hexadecimal Object File Format Specification", revision A, 1988).
#include <utility>

#include "loader/hex_record.h"
#include "loader/program_file.h"

namespace capsoc::loader {
namespace {

/// Takes records into an image.
class HexReader {
 public:
  explicit HexReader(std::string path) { image_.path = std::move(path); }

  /// What is wrong with a line, or null.
  const char* line(std::string_view text) {
    if (text[0] != ':') return "does not begin with a colon";
    const auto bytes = hex_bytes(text.substr(1));
    if (!bytes || bytes->size() < 5) return "is no record of whole bytes";
    if (bytes->size() != std::size_t{(*bytes)[0]} + 5) return "has a wrong length";
    uint8_t sum = 0;
    for (const uint8_t b : *bytes) sum = static_cast<uint8_t>(sum + b);
    if (sum != 0) return "has a wrong checksum";
    if (ended_) return "stands after the end record";
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
        return append_data(image_, uint64_t{base_} + offset, data);
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

  ElfImage image_;
  uint32_t base_ = 0;
  bool ended_ = false;
};

}  // namespace

Result<ElfImage> parse_hex(const std::string& path, const std::string& text) {
  return read_records<HexReader>(path, text, "ihex");
}

}  // namespace capsoc::loader
