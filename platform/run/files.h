// Files that are written whole or not at all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "support/result.h"

namespace capsoc::run {

/// A file to be written.
struct TextFile {
  std::string path, text;
};

/// Writes the whole file or nothing: a temporary file beside it, renamed at the end.
std::optional<Error> write_whole(const std::string& path, const std::string& text);

/// The same for files that belong together: none gets its name before all are complete.
std::optional<Error> write_together(const std::vector<TextFile>& files);

/// Whether write_whole() could write there, tried before a long run and not after it. Leaves
/// nothing behind.
std::optional<Error> check_writable(const std::string& path);

}  // namespace capsoc::run
