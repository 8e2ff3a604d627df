// A recording as a WAV file.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "host/growing_stream.h"
#include "metrics/sample_writer.h"

namespace capsoc::metrics {

/// U and V as two channels of PCM of 32 bits: the words themselves. The rate in the header is a
/// whole number of Hz, at least 1. Beyond 4 GB it becomes RF64. Source of the format: EBU Tech
/// 3306.
class WavRecording final : public SampleWriter {
 public:
  /// An Error: nothing can be written there, or other columns are asked for.
  static Result<std::unique_ptr<SampleWriter>> begin(const Recording& recording);

  void add(const RecordedSample& sample) override;
  std::optional<Error> finish() override;

 private:
  explicit WavRecording(host::GrowingStream file);

  host::GrowingStream file_;
  uint64_t samples_ = 0;
  double last_s_ = 0;
};

}  // namespace capsoc::metrics
