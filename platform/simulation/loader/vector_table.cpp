#include "loader/vector_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace capsoc::loader {
namespace {

constexpr uint32_t address_bits = 0x3FFFFF80;  // of VTOR

bool covers_reset_vectors(const ElfImage& image) {
  return std::any_of(image.segments.begin(), image.segments.end(), [](const Segment& segment) {
    return segment.address == 0 && segment.memory_size >= 8;
  });
}

bool begins_with_vectors(const Segment& segment, uint32_t entry) {
  if ((segment.address & ~address_bits) != 0 || segment.bytes.size() < 8) return false;
  uint32_t reset = 0;
  for (unsigned i = 0; i < 4; ++i) reset |= uint32_t{segment.bytes[4 + i]} << (8 * i);
  return (reset & 1) != 0 && reset == (entry | 1);
}

Result<uint32_t> as_given(const std::string& text) {
  char* end = nullptr;
  const unsigned long long address = std::strtoull(text.c_str(), &end, 0);
  const bool number = !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])) != 0;
  if (number && *end == '\0' && (address & ~uint64_t{address_bits}) == 0)
    return static_cast<uint32_t>(address);
  return Error{fmt::format(
      "--vector-table {}: is no address of a vector table; give a multiple of 0x80 below "
      "0x40000000, or auto",
      text)};
}

}  // namespace

Result<uint32_t> find_vector_table(const std::vector<const ElfImage*>& images,
                                   const std::string& wanted) {
  if (wanted != "auto") return as_given(wanted);
  for (const ElfImage* image : images)
    if (covers_reset_vectors(*image)) return uint32_t{0};
  for (const ElfImage* image : images) {
    const Segment* first = nullptr;
    for (const Segment& segment : image->segments)
      if (begins_with_vectors(segment, image->entry) &&
          (first == nullptr || segment.address < first->address))
        first = &segment;
    if (first != nullptr) return first->address;
  }
  return Error{fmt::format(
      "{}: nothing is loaded at 0, and no segment begins with a vector table for the entry point "
      "{:#010x}; name its address with --vector-table",
      images.front()->path, images.front()->entry)};
}

}  // namespace capsoc::loader
