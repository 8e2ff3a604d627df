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

/// What comes on standard input until its end. An Error: it cannot be read, or is longer than
/// `largest`.
Result<std::string> read_standard_input(std::size_t largest);

/// Writes the whole file or nothing: a temporary file next to it, renamed at the end. A symbolic
/// link stays one; the file that it leads to is written.
std::optional<Error> write_whole(const std::string& path, const std::string& text);

/// The same for files that belong together: none gets its name before all are complete.
std::optional<Error> write_together(const std::vector<TextFile>& files);

/// The sentence for what cannot be written; `error` as errno has it.
Error cannot_write(const std::string& path, int error);

/// Opens what exists for writing, with O_CLOEXEC and these flags. A pipe without a reader waits for
/// its reader until the program is ending. A descriptor, or -1 with errno (EINTR: it was ending).
int open_to_write(const std::string& path, int flags);

/// Where a file grows until it is whole: next to its place. A device, a pipe or a descriptor of
/// this program (/dev/stdout) grows in its place.
std::string growing_name(const std::string& path);
/// Opens that for writing; null with errno on failure.
std::FILE* open_growing(const std::string& path);
/// A file on its way to its name. Without name() it is removed in the end, and by a signal that
/// ends the program.
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
  /// Once it is complete and closed.
  std::optional<Error> name();

 private:
  std::string path_, growing_;
  std::optional<RemovedAtSignal> removed_;
};

/// Whether write_whole() could write there, tried before a long run and not after it. Leaves
/// nothing behind.
std::optional<Error> check_writable(const std::string& path);

}  // namespace capsoc::host
