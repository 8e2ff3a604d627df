// Programs in the formats that tool chains write other than ELF.
#pragma once

#include <string>

#include "loader/elf_image.h"

namespace capsoc::loader {

/// An ELF executable, an Intel HEX file or S-records, told apart by their first bytes. The last two
/// have no symbols.
Result<ElfImage> load_program(const std::string& path);

/// Intel HEX: records 00 to 05. Damage is an error that names file and line.
Result<ElfImage> load_hex(const std::string& path);
/// The text of such a file.
Result<ElfImage> parse_hex(const std::string& path, const std::string& text);

/// The text of a file of Motorola S-records: types 0 to 9 without 4, their count checked. Damage is
/// an error that names file and line.
Result<ElfImage> parse_srec(const std::string& path, const std::string& text);

/// `FILE@ADDRESS`: the bytes of a file as they are, from the address on (0x.. or decimal).
/// `FILE` alone: as load_program().
Result<ElfImage> load_at(const std::string& place);

}  // namespace capsoc::loader
