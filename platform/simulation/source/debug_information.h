// What a program's debug information (DWARF) says of its code.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "source/call_frame_information.h"
#include "source/registers.h"

namespace capsoc::source {

class ElfCopy;

/// A source file as the compiler was given it. Control characters are replaced; all other bytes are
/// those of the name.
struct SourceFile {
  std::string name;    ///< absolute, or relative to `folder`
  std::string folder;  ///< where the compiler ran (DW_AT_comp_dir); "": not known
};

/// A line of a source file; line 0: the file alone is known.
struct SourceLine {
  std::string file;  ///< SourceFile::name without a leading "./"
  unsigned line = 0;
};

/// A function that an address belongs to, and where in it.
struct Place {
  std::string function;
  SourceLine at;         ///< of the outer functions: the call that was inlined
  bool inlined = false;  ///< into the next one
};

/// Read once, asked as often as needed. Damage is no error: what cannot be read is not there, and
/// is named in complaints().
class DebugInformation {
 public:
  /// `name`: of the file, for complaints; `bytes`: its contents, ELF or not.
  DebugInformation(std::string name, const std::string& bytes);
  ~DebugInformation();
  DebugInformation(const DebugInformation&) = delete;
  DebugInformation& operator=(const DebugInformation&) = delete;

  bool has_lines() const { return !rows_.empty(); }
  bool has_frames() const { return frames_ != nullptr; }

  std::optional<SourceLine> line_at(uint32_t address) const;
  /// The functions at an address, the innermost first: what was inlined there, then the function
  /// itself. Empty: none is described. The newest answers are kept: valid until the next call.
  const std::vector<Place>& places_at(uint32_t address) const;
  Unwound unwind(uint32_t address, Registers& registers, const ReadWord& read) const {
    return unwind_by_description(frames_, address, registers, read);
  }

  /// Every instruction address at which a statement begins, with its line.
  struct Row {
    uint32_t address = 0;
    unsigned file = 0, line = 0;  ///< the file's index in files()
    bool end = false;             ///< after a sequence: nothing is known from here on
    bool statement = false;
  };
  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<SourceFile>& files() const { return files_; }
  /// The row whose line an address has, null if it has none.
  const Row* row_at(uint32_t address) const;

  /// One sentence for each part that is there and cannot be read.
  std::vector<std::string> complaints() const { return {complaints_.begin(), complaints_.end()}; }

 private:
  struct Unit {
    uint32_t first = 0, behind = 0;
    uint64_t die = 0;  ///< offset of the unit's entry
  };
  void read_units();
  void read_ranges(Dwarf_Die& unit);
  void read_rows(Dwarf_Die& unit);
  unsigned file_index(const char* name, const std::string& folder);
  std::vector<Place> search_places(uint32_t address) const;
  void complain(const std::string& what) const;

  std::string name_;
  std::unique_ptr<ElfCopy> copy_;
  Dwarf_CFI* frames_ = nullptr;
  std::vector<Unit> units_;
  std::vector<Row> rows_;  ///< by address
  std::vector<SourceFile> files_;
  std::map<std::pair<std::string, std::string>, unsigned> file_numbers_;  ///< by folder and name
  mutable std::set<std::string> complaints_;
  mutable std::unordered_map<uint32_t, std::vector<Place>> places_;  ///< that were asked for
};

}  // namespace capsoc::source
