// loader::load_elf() without libelf, for the segments of a program that is sound.
#include <elf.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "loader/elf_image.h"

namespace capsoc::loader {

Result<ElfImage> load_elf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  Elf32_Ehdr header;
  if (bytes.size() < sizeof header) return Error{path + ": cannot be read"};
  std::memcpy(&header, bytes.data(), sizeof header);
  ElfImage image;
  for (unsigned i = 0; i < header.e_phnum; ++i) {
    Elf32_Phdr segment;
    std::memcpy(&segment, bytes.data() + header.e_phoff + i * sizeof segment, sizeof segment);
    if (segment.p_type != PT_LOAD) continue;
    const char* const first = bytes.data() + segment.p_offset;
    image.segments.push_back({segment.p_paddr, {first, first + segment.p_filesz}, segment.p_memsz});
  }
  return image;
}

}  // namespace capsoc::loader
