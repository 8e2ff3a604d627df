// A folder for temporary files.
#pragma once

#include <unistd.h>

#include <string>

#include "base/result.h"
#include "host/descriptor.h"

namespace capsoc::host {

/// Gone with its owner, unless that is a forked copy of it. One whose process was killed is removed
/// by the next one of its name.
class TemporaryFolder {
 public:
  /// capsoc-NAME-XXXXXX where temporary files go (TMPDIR, otherwise /tmp). An Error names the place
  /// and what to do.
  static Result<TemporaryFolder> make(const std::string& name);
  ~TemporaryFolder();
  TemporaryFolder(TemporaryFolder&& other) noexcept = default;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  TemporaryFolder(std::string path, Descriptor lock)
      : path_(std::move(path)), lock_(std::move(lock)) {}

  std::string path_;
  Descriptor lock_;  ///< held as long as the process lives; invalid: moved away
  pid_t owner_ = getpid();
};

}  // namespace capsoc::host
