// A file that is written in pieces and renamed when it is complete.
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

/// Its memory does not grow with the file, which is a temporary file next to its place
/// (GrowingFile). For a pipe, a device or a descriptor it is an unnamed temporary file, copied at
/// the end. So a reader gets the complete file at once, and no part of it if the run fails.
class GrowingStream {
 public:
  /// An Error: nothing can be written there.
  static Result<GrowingStream> open(const std::string& path);

  /// The first failure is kept for finish(), and what comes after it is dropped.
  void write(std::string_view text);

  /// Overwrites bytes from offset `place`, such as a header with sizes. Later writes still append.
  void replace(long place, std::string_view bytes);

  /// Appends the rewritten form of the next piece of text to `out`. The output may not be longer
  /// than the input so far.
  using Rewrite = std::function<void(std::string_view piece, std::string& out)>;
  /// Rewrites the whole file in a shorter form.
  void shrink(const Rewrite& rewrite);

  /// The last call: gives the file its name. An Error: the first failure; then no file gets the
  /// name.
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
