// Types of a program's debug information.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "source/elf_copy.h"
#include "source/variables.h"

namespace capsoc::source {

/// Reads each type once and keeps it. What is damaged is opaque.
class TypeReader {
 public:
  /// The type that an entry names (DW_AT_type); null: none, C's void.
  const Type* type_of(Dwarf_Die* entry);

 private:
  const Type* read(Dwarf_Die* entry);
  void read_base(Dwarf_Die* entry, Type& type) const;
  void read_structure(Dwarf_Die* entry, Type& type);
  void read_array(Dwarf_Die* entry, Type& type);
  void read_enumeration(Dwarf_Die* entry, Type& type) const;
  const Type* named_anew(Dwarf_Die* entry, Type& type, const char* qualifier);

  std::map<Dwarf_Off, std::unique_ptr<Type>> types_;
  std::vector<std::unique_ptr<Type>> rows_;  ///< of arrays with several dimensions
  unsigned depth_ = 0;
};

/// DW_AT_name, also of the declaration that an entry completes; "" without.
std::string name_of(Dwarf_Die* entry);

}  // namespace capsoc::source
