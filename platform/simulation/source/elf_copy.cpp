#include "source/elf_copy.h"

#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

namespace capsoc::source {
namespace {

struct Extent {
  std::size_t offset, size;
};

/// Where a section lies in the file; nothing unless it is there as a whole.
std::optional<Extent> find_section(Elf* elf, const char* name, std::size_t file_size) {
  std::size_t names = 0;
  if (elf == nullptr || elf_getshdrstrndx(elf, &names) != 0) return std::nullopt;
  for (Elf_Scn* section = nullptr; (section = elf_nextscn(elf, section)) != nullptr;) {
    GElf_Shdr header;
    if (gelf_getshdr(section, &header) == nullptr || header.sh_type == SHT_NOBITS) continue;
    const char* text = elf_strptr(elf, names, header.sh_name);
    if (text == nullptr || std::strcmp(text, name) != 0) continue;
    if (header.sh_offset > file_size || header.sh_size > file_size - header.sh_offset)
      return std::nullopt;
    return Extent{header.sh_offset, header.sh_size};
  }
  return std::nullopt;
}

}  // namespace

ElfCopy::ElfCopy(std::string bytes) : bytes_(std::move(bytes)) {
  elf_version(EV_CURRENT);
  elf_ = elf_memory(bytes_.data(), bytes_.size());
  if (elf_ == nullptr) return;
  move_frames_left_out();
  move_lines_left_out();
  dwarf_ = dwarf_begin_elf(elf_, DWARF_C_READ, nullptr);
}

ElfCopy::~ElfCopy() {
  if (dwarf_ != nullptr) dwarf_end(dwarf_);
  if (elf_ != nullptr) elf_end(elf_);
}

bool ElfCopy::has_section(const char* name) const {
  const auto section = find_section(elf_, name, bytes_.size());
  return section && section->size > 0;
}

/// 32-bit DWARF (6.4.1): a length, the offset of the CIE (all ones: it is one), the first address
/// and the size of what is described.
void ElfCopy::move_frames_left_out() {
  constexpr std::size_t header = 16;
  constexpr uint32_t is_cie = 0xFFFFFFFF;
  const auto section = find_section(elf_, ".debug_frame", bytes_.size());
  if (!section) return;
  std::size_t at = section->offset;
  const std::size_t end = section->offset + section->size;
  while (end - at >= header) {
    uint32_t words[4];
    std::memcpy(words, bytes_.data() + at, sizeof words);
    if (words[1] != is_cie && words[2] == 0) {
      const uint32_t moved[2] = {left_out, 1};
      std::memcpy(bytes_.data() + at + 8, moved, sizeof moved);
    }
    if (words[0] > end - at - 4) return;
    at += 4 + std::size_t{words[0]};
  }
}

/// A sequence of lines begins with DW_LNE_set_address: 0, the length 5, the code 2, the address.
void ElfCopy::move_lines_left_out() {
  const auto section = find_section(elf_, ".debug_line", bytes_.size());
  if (!section) return;
  const std::string set_to_zero("\x00\x05\x02\x00\x00\x00\x00", 7);
  const std::size_t end = section->offset + section->size;
  std::size_t at = bytes_.find(set_to_zero, section->offset);
  while (at != std::string::npos && at + set_to_zero.size() <= end) {
    std::memcpy(bytes_.data() + at + 3, &left_out, sizeof left_out);
    at = bytes_.find(set_to_zero, at + set_to_zero.size());
  }
}

}  // namespace capsoc::source
