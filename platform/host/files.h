// Files that are written whole or not at all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "support/result.h"

namespace capsoc::host {

/// A file to be written.
struct TextFile {
  std::string path, text;
};

/// Writes the whole file or nothing: a temporary file beside it, renamed at the end.
std::optional<Error> write_whole(const std::string& path, const std::string& text);

/// The same for files that belong together: none gets its name before all are complete.
std::optional<Error> write_together(const std::vector<TextFile>& files);

/// The sentence for what cannot be written; `error` as errno has it.
Error cannot_write(const std::string& path, int error);

/// Where a file grows until it is whole: beside its place. A device or a pipe grows in its place.
std::string growing_name(const std::string& path);
/// Gives what has grown there its name.
std::optional<Error> name_grown(const std::string& path);
/// Or removes it.
void discard_grown(const std::string& path);

/// Whether write_whole() could write there, tried before a long run and not after it. Leaves
/// nothing behind.
std::optional<Error> check_writable(const std::string& path);

}  // namespace capsoc::host
