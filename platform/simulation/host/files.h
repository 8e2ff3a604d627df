// Files that are written whole or not at all.
#pragma once

#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "host/end_signals.h"

namespace capsoc::host {

/// A file to be written.
struct TextFile {
  std::string path, text;
};

/// Reads standard input to its end. An Error: it cannot be read, or is longer than `largest`.
Result<std::string> read_standard_input(std::size_t largest);

/// Writes the whole file or nothing: a temporary file next to it, renamed at the end. A symbolic
/// link stays one; the file that it leads to is written.
std::optional<Error> write_whole(const std::string& path, const std::string& text);

/// The same for files that belong together: none gets its name before all are complete.
std::optional<Error> write_together(const std::vector<TextFile>& files);

/// The sentence for what cannot be written; `error` as errno has it.
Error cannot_write(const std::string& path, int error);

/// Opens an existing file for writing, with O_CLOEXEC and these flags. For a pipe it waits for a
/// reader until the program is ending. Returns a descriptor, or -1 with errno (EINTR: the program
/// is ending).
int open_to_write(const std::string& path, int flags);

/// Name of the temporary file, next to `path`, in which a file is written until it is complete. A
/// device, a pipe or a descriptor of this program (/dev/stdout) is written in place.
std::string growing_name(const std::string& path);
/// Opens that for writing; null with errno on failure.
std::FILE* open_growing(const std::string& path);
/// A temporary file that gets its name when it is complete. Without name() it is removed at
/// destruction, or by a signal that ends the program.
class GrowingFile {
 public:
  explicit GrowingFile(const std::string& path);
  ~GrowingFile();
  GrowingFile(GrowingFile&& other) noexcept;
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;
  GrowingFile& operator=(GrowingFile&&) = delete;

  const std::string& path() const { return path_; }
  const std::string& growing() const { return growing_; }
  /// Renames the file. Call when it is complete and closed.
  std::optional<Error> name();

 private:
  std::string path_, growing_;
  std::optional<RemovedAtSignal> removed_;
};

/// Checks that write_whole() can write there, for a test before a long run. Leaves no file.
std::optional<Error> check_writable(const std::string& path);

}  // namespace capsoc::host
