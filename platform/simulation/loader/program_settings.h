// Settings that a program describes itself, as firmware/common/program_settings.h lays them out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "loader/elf_image.h"

namespace capsoc::loader {

/// One value that may be changed in the image before it is loaded.
struct ProgramSetting {
  enum class Kind { unsigned_number, signed_number, text };
  std::string name;
  std::string unit;  ///< "" without
  std::string help;
  Kind kind = Kind::unsigned_number;
  uint32_t offset = 0;              ///< from the beginning of the object, bytes
  uint32_t size = 0;                ///< 1, 2, 4 or 8 bytes; a text's array with its last 0
  int64_t per_unit = 1;             ///< the word that stands for 1
  int64_t least = 0, greatest = 0;  ///< words
};

/// A program's settings with their values. Whatever the file holds, nothing outside the object
/// `program_settings` is read or written.
class ProgramSettings {
 public:
  /// No settings at all if the program has no such object; an Error, which names the file, if the
  /// object contradicts itself.
  static Result<ProgramSettings> read(const ElfImage& image);

  const std::vector<ProgramSetting>& all() const { return all_; }
  /// Null if there is none of that name.
  const ProgramSetting* find(const std::string& name) const;

  /// The value as a user writes it: a number in the setting's unit with as many digits as its word
  /// needs, or the text itself.
  std::string value(const ProgramSetting& setting) const;
  /// "1 .. 100000", "at most 15 characters"
  std::string range(const ProgramSetting& setting) const;

  /// Takes a value as a user writes it. `origin` begins the error sentence.
  std::optional<Error> set(const ProgramSetting& setting, const std::string& text,
                           const std::string& origin);

  /// Writes the values in the image that they were read from.
  void write(ElfImage& image) const;

 private:
  std::string number(const ProgramSetting& setting, int64_t word) const;
  int64_t word(const ProgramSetting& setting) const;

  std::vector<uint8_t> bytes_;  ///< the whole object
  std::vector<ProgramSetting> all_;
};

}  // namespace capsoc::loader
