// Files of the host that the guest may use: those below one directory.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

#include "base/archive.h"
#include "base/result.h"
#include "host/descriptor.h"

namespace capsoc::semihosting {

/// Every function returns a negative errno value on failure. Names are relative to the directory;
/// an absolute name, `..` and any symbolic link on the way are refused (EACCES, ELOOP, ENOTDIR), so
/// nothing outside can be reached. Only regular files are opened.
class GuestFiles {
 public:
  static constexpr uint64_t largest_file = 256U << 20U;  ///< bytes
  static constexpr uint64_t most_written = 1U << 30U;    ///< bytes of all writes of a run

  /// No directory: every name is refused with EACCES.
  GuestFiles() = default;
  /// An Error if `directory` is none.
  static Result<GuestFiles> in(const std::string& directory);

  /// `mode`: 0 to 11, as fopen's r, rb, r+, r+b, w, ... a+b.
  int open(const std::string& name, unsigned mode, host::Descriptor& file) const;
  /// A file that was open when state was saved, with its size and position then. -ESTALE: it is
  /// shorter than it was.
  int reopen(const std::string& name, unsigned mode, uint64_t size, uint64_t position,
             host::Descriptor& file) const;
  /// What a file that is written has after its first `size` bytes goes.
  static void cut(const host::Descriptor& file, uint64_t size);
  int remove(const std::string& name) const;
  int rename(const std::string& from, const std::string& to) const;
  /// As write(2), within the bounds above.
  ssize_t write(const host::Descriptor& file, const void* data, std::size_t size);

  void visit(Archive& archive) { archive("written", written_); }

 private:
  struct Place {
    host::Descriptor folder;
    std::string name;
  };
  int find(const std::string& name, Place& place) const;
  int open_with(const std::string& name, int flags, host::Descriptor& file) const;

  host::Descriptor directory_;
  uint64_t written_ = 0;
};

}  // namespace capsoc::semihosting
