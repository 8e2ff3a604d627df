// The variables of a program by their names in its source, with their types (DWARF).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "loader/elf_image.h"

namespace capsoc::source {

/// A C type as it lies in the memory of the processor, little-endian.
struct Type {
  enum class Kind : uint8_t {
    integer,
    character,  ///< an integer that is text in an array
    boolean,
    floating,
    pointer,
    enumeration,
    structure,  ///< or a union
    array,
    opaque,  ///< bytes of which no more is known
  };
  struct Member;

  Kind kind = Kind::opaque;
  std::string name;   ///< as C writes it: "uint32_t", "struct state", "int [4]"
  uint32_t size = 0;  ///< bytes
  bool is_signed = false;
  std::vector<Member> members = {};  ///< of a structure
  const Type* target = nullptr;      ///< of an array: each element; of a pointer
  uint32_t count = 0;                ///< of an array
  std::vector<std::pair<std::string, int64_t>> enumerators = {};
};

struct Type::Member {
  std::string name;
  const Type* type = nullptr;
  uint32_t offset = 0;  ///< bytes from the beginning of the structure
  unsigned bits = 0;    ///< of a bit-field; 0: it is none
  unsigned bit = 0;     ///< of a bit-field: its lowest one, from `offset`
};

/// Something in memory.
struct Variable {
  std::string name;
  uint32_t address = 0;
  const Type* type = nullptr;  ///< lives as long as the Variables
  unsigned bits = 0, bit = 0;  ///< as Type::Member has them

  /// Bytes from its address on; of a bit-field those up to its end.
  uint32_t size() const { return bits > 0 ? (bit + bits + 7) / 8 : type->size; }
};

/// Reads a word of the program's memory; nothing where there is none.
using ReadPointer = std::function<std::optional<uint32_t>(uint32_t address)>;

/// Reads the debug information when it is asked for the first time. Damage is no error: what cannot
/// be read is not there. The images must outlive it.
class Variables {
 public:
  explicit Variables(std::vector<const loader::ElfImage*> images);
  ~Variables();
  Variables(const Variables&) = delete;
  Variables& operator=(const Variables&) = delete;

  /// "turns", "state.angle", "table[3]", "list->next->value", "*pointer", and "main.c::count" where
  /// several files have a `count`. An Error says which part there is none of, or which names there
  /// are.
  Result<Variable> find(const std::string& path, const ReadPointer& read) const;

  /// All that have a place in memory for the whole run, by name.
  std::vector<Variable> all() const;

 private:
  class Reader;
  struct Known {
    std::string file;  ///< that defines it, without folders
    Variable variable;
  };
  void read() const;
  Result<Variable> named(const std::string& name) const;
  std::optional<Variable> symbol(const std::string& name) const;
  const Type* plain(uint32_t size) const;

  std::vector<const loader::ElfImage*> images_;
  mutable bool is_read_ = false;
  mutable std::multimap<std::string, Known> variables_;
  mutable std::vector<std::unique_ptr<Reader>> readers_;
  mutable std::map<uint32_t, std::unique_ptr<Type>> plain_;  ///< of symbols, by size
};

}  // namespace capsoc::source
