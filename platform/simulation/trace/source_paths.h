// Where the sources that a program's debug information names are on this machine.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "source/debug_information.h"

namespace capsoc::trace {

/// A relative name is one below the folder where the compiler ran. That folder may be relative, too
/// (-fdebug-prefix-map, -ffile-prefix-map): then it, and the name itself, are looked for in the
/// current folder, in the program's, and in those above that.
class SourcePaths {
 public:
  /// `program`: the ELF file.
  explicit SourcePaths(const std::string& program);

  /// The absolute path without "." and ".."; of a relative name with a relative folder that is not
  /// found the name itself. Nothing: the file is not here, as those of a library that was compiled
  /// on another machine.
  std::optional<std::string> find(const source::SourceFile& file) const;

 private:
  std::vector<std::filesystem::path> places_;
};

}  // namespace capsoc::trace
