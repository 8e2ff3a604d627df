// What the disk of a store can do, and a store that may only be read.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "host/temporary_folder.h"

namespace capsoc::campaign {

/// Why the file has no POSIX locks, which SQLite needs to write: the words of the system, or "".
std::string why_no_locks(int file);

/// Whether programs that map the file share its memory, which SQLite's WAL needs (sqlite.org,
/// wal.html). False for the file systems of networks, whose computers do not share it.
bool shares_memory(int file);

/// Whether a writer that was killed left something next to the file that belongs to it.
bool has_unfinished(const std::string& store);

/// A copy of a store, with what is next to it, in its own folder that goes with it.
class StoreCopy {
 public:
  /// Error: there is no place for it.
  static Result<std::unique_ptr<StoreCopy>> of(const std::string& store);

  std::string path() const { return folder_.path() + "/store"; }

 private:
  explicit StoreCopy(host::TemporaryFolder folder) : folder_(std::move(folder)) {}

  host::TemporaryFolder folder_;
};

}  // namespace capsoc::campaign
