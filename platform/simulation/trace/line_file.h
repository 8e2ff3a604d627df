// A text file that grows line by line.
#pragma once

#include <cstddef>
#include <cstdio>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "host/files.h"

namespace capsoc::trace {

/// Written next to its place while the run lasts and named at the end, so that there is a whole
/// file or none. With a depth only the last lines are kept, in memory, and written at the end.
class LineFile {
 public:
  /// `depth` 0: all lines. An Error: nothing can be written there.
  static Result<std::unique_ptr<LineFile>> open(const std::string& path, std::size_t depth);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  /// Stays in front of the lines, whatever the depth.
  void heading(std::string text) { heading_ = std::move(text); }
  /// A line without its end.
  void put(std::string line);
  /// The last call.
  std::optional<Error> finish();

 private:
  LineFile(const std::string& path, std::size_t depth);
  void write(const std::string& line);

  host::GrowingFile growing_;
  std::string heading_;
  std::size_t depth_;
  std::deque<std::string> kept_;
  std::FILE* file_ = nullptr;
  int error_ = 0;  ///< errno of the first failure
};

}  // namespace capsoc::trace
