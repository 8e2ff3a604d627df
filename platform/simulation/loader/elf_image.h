// A program for the guest: loadable segments and symbols of an ELF file.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace capsoc::loader {

/// A run of bytes at a physical address.
struct Segment {
  uint32_t address;
  std::vector<uint8_t> bytes;  ///< file contents
  uint32_t memory_size;        ///< >= bytes.size(); the rest is zero
};

/// A function or an object of the program.
struct Symbol {
  uint32_t address;
  uint32_t size;
  std::string name;   ///< mangled, as a terminal and a text file may have it (support/printable.h)
  bool weak = false;  ///< an alias that another definition may replace
  bool is_code = false;  ///< a function, or a label of assembly
};

/// Where code or data begins inside a section (ELF for the Arm Architecture, mapping symbols).
struct Mapping {
  uint32_t address;
  bool is_code;
};

/// What an ELF file holds for a Cortex-M.
struct ElfImage {
  std::string path;
  uint32_t entry = 0;
  std::vector<Segment> segments;
  std::vector<Symbol> symbols;    ///< sorted by address
  std::vector<Mapping> mappings;  ///< sorted by address
  /// The file's bytes, for its debug information; null for what is no ELF file.
  std::shared_ptr<const std::string> file;

  /// The symbol that covers the address (Thumb bit ignored), null if there is none.
  const Symbol* symbol_at(uint32_t address) const;

  /// Whether the file says that code is there; without mapping symbols it does not.
  bool is_code(uint32_t address) const;

  /// "name+0x12", demangled, of the symbol that covers the address (Thumb bit ignored), "" if there
  /// is none.
  std::string symbolise(uint32_t address) const;
  /// By the symbol's name, or by its demangled one.
  std::optional<uint32_t> address_of(const std::string& name) const;

  /// The initial contents of an object. Nothing unless there is an object of that name whose bytes
  /// are in the file (constant, not .bss).
  std::optional<std::vector<uint8_t>> contents(const std::string& name) const;

  /// Replaces the initial contents of an object. False, with nothing changed, unless there is an
  /// object of that name and exactly that size whose bytes are in the file (constant, not .bss).
  bool overwrite(const std::string& name, const std::vector<uint8_t>& bytes);
};

/// Reads a 32-bit little-endian ARM executable. Every damage is an error that names the file.
Result<ElfImage> load_elf(const std::string& path);
/// The bytes of such a file.
Result<ElfImage> parse_elf(const std::string& path, std::string bytes);
/// The bytes of a file that may be a program.
Result<std::string> read_program(const std::string& path);

}  // namespace capsoc::loader
