// Motorola S-records (Motorola, "M68000 Family Programmer's Reference Manual", appendix C).
#include <utility>

#include "loader/hex_record.h"
#include "loader/program_file.h"

namespace capsoc::loader {
namespace {

/// Takes records into an image.
class SRecordReader {
 public:
  explicit SRecordReader(std::string path) { image_.path = std::move(path); }

  /// What is wrong with a line, or null. A record: S, its type, then bytes: how many follow, the
  /// address, the data, and the ones' complement of the sum of all of these.
  const char* line(std::string_view text) {
    if (text.size() < 2 || text[0] != 'S') return "does not begin with S and a type";
    const auto bytes = hex_bytes(text.substr(2));
    if (!bytes || bytes->empty()) return "is no record of whole bytes";
    if (bytes->size() != std::size_t{(*bytes)[0]} + 1) return "has a wrong length";
    uint8_t sum = 0;
    for (const uint8_t b : *bytes) sum = static_cast<uint8_t>(sum + b);
    if (sum != 0xFF) return "has a wrong checksum";
    if (ended_) return "stands after the end record";
    const std::size_t width = address_width(text[1]);
    if (width == 0) return "has a type that S-records do not know";
    if (bytes->size() < width + 2) return "is too short for its address";
    uint32_t address = 0;
    for (std::size_t i = 1; i <= width; ++i) address = address << 8U | (*bytes)[i];
    return record(text[1], address,
                  {bytes->begin() + 1 + static_cast<std::ptrdiff_t>(width), bytes->end() - 1});
  }
  bool ended() const { return ended_; }
  ElfImage take() { return std::move(image_); }

 private:
  /// In bytes; 0: there is no such type.
  static std::size_t address_width(char type) {
    switch (type) {
      case '0':
      case '1':
      case '5':
      case '9':
        return 2;
      case '2':
      case '6':
      case '8':
        return 3;
      case '3':
      case '7':
        return 4;
      default:
        return 0;
    }
  }

  const char* record(char type, uint32_t address, const std::vector<uint8_t>& data) {
    if (type == '0') return nullptr;  // a name
    if (type <= '3') {
      ++data_records_;
      return append_data(image_, address, data);
    }
    if (!data.empty()) return "has data, and its type has none";
    if (type == '5' || type == '6') {
      const uint32_t counted = type == '5' ? 0xFFFF : 0xFFFFFF;
      return address == (data_records_ & counted) ? nullptr
                                                  : "counts other data records than there are";
    }
    ended_ = true;
    image_.entry = address;
    return nullptr;
  }

  ElfImage image_;
  uint32_t data_records_ = 0;
  bool ended_ = false;
};

}  // namespace

Result<ElfImage> parse_srec(const std::string& path, const std::string& text) {
  return read_records<SRecordReader>(path, text, "srec");
}

}  // namespace capsoc::loader
