// Recordings of samples that grow on disk while a run lasts.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "metrics/sample_record.h"

namespace capsoc::metrics {

/// A recording that takes one sample at a time, in memory that does not grow with it. Every format
/// of `--record` implements it. Destroyed without finish(), it leaves nothing behind.
class SampleWriter {
 public:
  virtual ~SampleWriter() = default;

  /// The next sample. A failure is kept for finish(), and what comes after it is dropped.
  virtual void add(const RecordedSample& sample) = 0;

  /// The last call: completes the recording and gives it its name. An Error: it could not be
  /// written, and an older file of that name is as it was.
  virtual std::optional<Error> finish() = 0;
};

/// What a recording is to be, in any format.
struct Recording {
  std::string path;
  std::string origin;  ///< a comment that says where it comes from, for formats that have comments
  RecordColumns columns;
};

}  // namespace capsoc::metrics
