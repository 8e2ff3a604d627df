// The place of a wave file that GTKWave's library writes.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "host/files.h"

namespace capsoc::trace {

/// Grows next to its name. The library removes what has its name, so no device may; and it does not
/// tell of a disk that was full, so the file is looked through before it gets its name.
class WaveFile {
 public:
  /// An Error: nothing can be written there, or the name is that of another format.
  static Result<WaveFile> at(const std::string& path);

  /// What the library opens.
  const std::string& growing() const { return file_.growing(); }
  /// After the library has closed it: the file has its name, or it is gone and the Error says why.
  std::optional<Error> finish();

 private:
  explicit WaveFile(const std::string& path);

  host::GrowingFile file_;
  host::RemovedAtSignal hierarchy_;  ///< next to it as long as it is open
};

}  // namespace capsoc::trace
