// Where a program's vector table is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "loader/elf_image.h"

namespace capsoc::loader {

/// `wanted`: an address (0x.. or decimal), or "auto". Auto is 0 if any image has bytes there, as
/// the board boots. Otherwise it is the first segment that begins with a vector table, in the order
/// of the images and of their addresses. Such a segment is aligned to 128 bytes, and its second
/// word is the image's entry point with the Thumb bit. An Error says that there is none, or that
/// the address cannot be one (B3.2.5: bits 29 to 7).
Result<uint32_t> find_vector_table(const std::vector<const ElfImage*>& images,
                                   const std::string& wanted);

}  // namespace capsoc::loader
