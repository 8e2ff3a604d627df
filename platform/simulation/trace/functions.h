// The program's functions by address.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "loader/elf_image.h"

namespace capsoc::trace {

/// Which function an instruction belongs to. Symbols of several images may be added.
class Functions {
 public:
  struct Function {
    uint32_t address = 0;
    std::string name;  ///< demangled
  };
  /// Index of what has no symbol.
  static constexpr uint32_t unknown = 0;

  void add(const loader::ElfImage& image);

  /// Index of the function that covers the address (Thumb bit ignored).
  uint32_t at(uint32_t address);
  const Function& operator[](uint32_t index) const { return functions_[index]; }
  /// Enters a name without an address, for what is no function; its index.
  uint32_t add_name(const std::string& name);

  /// "main+0x4", or "" without a symbol.
  std::string place(uint32_t address);
  /// By the symbol's name, or by its demangled one.
  std::optional<uint32_t> address_of(const std::string& name) const;
  /// All names that have an address.
  std::vector<std::string> names() const;

 private:
  uint32_t look_up(uint32_t address) const;

  std::vector<loader::Symbol> symbols_;  ///< sorted by address; index + 1 is the function's
  std::vector<Function> functions_{{0, "[no symbol]"}};
  std::unordered_map<uint32_t, uint32_t> known_;
};

}  // namespace capsoc::trace
