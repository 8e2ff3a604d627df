// A program's segments into a memory.
#pragma once

#include <optional>

#include "base/result.h"
#include "loader/elf_image.h"

namespace capsoc::loader {

/// `memory.load(path, address, bytes)` of every segment, with the zeros after it, until one of
/// them is refused: its Error.
template <typename Memory>
std::optional<Error> place(const ElfImage& image, Memory& memory) {
  for (const Segment& segment : image.segments) {
    std::vector<uint8_t> bytes = segment.bytes;
    bytes.resize(segment.memory_size);
    if (auto error = memory.load(image.path, segment.address, bytes)) return error;
  }
  return std::nullopt;
}

}  // namespace capsoc::loader
