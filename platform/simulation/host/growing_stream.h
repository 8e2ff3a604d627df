// A file that grows piece by piece and is named when it is whole.
#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "host/files.h"

namespace capsoc::host {

/// Written in memory that does not grow with it, next to its place (GrowingFile). Where it is
/// written in place (a pipe, a device, a descriptor), it grows in a nameless temporary file that is
/// copied there at the end. So a reader gets all of it at once, and no half of it where the run
/// fails.
class GrowingStream {
 public:
  /// An Error: nothing can be written there.
  static Result<GrowingStream> open(const std::string& path);

  /// The first failure is kept for finish(), and what comes after it is dropped.
  void write(std::string_view text);

  /// Puts other bytes in the place of some that were written, `place` bytes after the first: a
  /// head that has sizes. What is written next still goes to the end.
  void replace(long place, std::string_view bytes);

  /// Appends to `out` what becomes of the next piece of the text; no more bytes than it had so far.
  using Rewrite = std::function<void(std::string_view piece, std::string& out)>;
  /// Writes all that there is again, shorter.
  void shrink(const Rewrite& rewrite);

  /// The last call: the file has its name. An Error: the first failure; nothing has the name that
  /// had it not before.
  std::optional<Error> finish();

 private:
  using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  GrowingStream(const std::string& path, Stream stream, bool in_place);
  void fail();
  bool copy_to_place();

  GrowingFile file_;
  Stream stream_;
  bool in_place_;
  int error_ = 0;  ///< errno of the first failure
};

}  // namespace capsoc::host
