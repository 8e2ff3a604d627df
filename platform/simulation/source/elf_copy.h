// A program's ELF file in memory, for the library that reads its debug information.
#pragma once

#include <dwarf.h>
#include <elfutils/libdw.h>
#include <gelf.h>

#include <cstdint>
#include <string>

namespace capsoc::source {

/// Functions that the linker left out are still described, as if they lay at 0 and after it, where
/// the board has code. In the copy their frames and lines are moved to this address and beyond.
constexpr uint32_t left_out = 0xFFFF0000;

/// A private copy of the file's bytes, opened.
class ElfCopy {
 public:
  explicit ElfCopy(std::string bytes);
  ~ElfCopy();
  ElfCopy(const ElfCopy&) = delete;
  ElfCopy& operator=(const ElfCopy&) = delete;

  /// Null: the file has no debug information that could be read.
  Dwarf* dwarf() const { return dwarf_; }
  /// The file has a section of that name with something in it.
  bool has_section(const char* name) const;

 private:
  void move_frames_left_out();
  void move_lines_left_out();

  std::string bytes_;
  Elf* elf_ = nullptr;
  Dwarf* dwarf_ = nullptr;
};

}  // namespace capsoc::source
