// What the translator makes of a program.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "armv7m/listeners.h"
#include "base/result.h"
#include "trace/functions.h"
#include "trace/line_file.h"

namespace capsoc::trace {

/// A text with the instructions of each translated block and the host's code below each of them.
/// And the names of the blocks where perf looks for them (/tmp/perf-PID.map), which stay there for
/// a perf report after the run.
class TranslationTrace {
 public:
  /// `listing` empty: none. An Error: a file that cannot be written.
  static Result<std::unique_ptr<TranslationTrace>> open(const std::string& listing, bool perf_map,
                                                        Functions& functions);
  ~TranslationTrace();
  TranslationTrace(const TranslationTrace&) = delete;
  TranslationTrace& operator=(const TranslationTrace&) = delete;

  void put(const armv7m::Translation& translation);
  /// The last call.
  std::optional<Error> finish();

 private:
  explicit TranslationTrace(Functions& functions) : functions_(functions) {}
  std::optional<Error> open_map();

  Functions& functions_;
  std::unique_ptr<LineFile> listing_;
  std::string map_path_;
  std::FILE* map_ = nullptr;
  uint64_t evictions_ = 0;
};

}  // namespace capsoc::trace
