// A recording as comma-separated values.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "host/growing_stream.h"
#include "metrics/sample_writer.h"

namespace capsoc::metrics {

/// A recording as `capsoc run` and `capsoc fit` read it (traces/README.md), if u and v are among
/// the columns. angle_deg is left out unless it is known for all samples; other cells without a
/// value are empty. Numbers have all their digits, so that u and v become the same words again in
/// a converter of 32 bits.
class CsvRecording final : public SampleWriter {
 public:
  /// An Error: nothing can be written there.
  static Result<std::unique_ptr<SampleWriter>> begin(Recording recording);

  void add(const RecordedSample& sample) override;
  std::optional<Error> finish() override;

 private:
  CsvRecording(Recording recording, host::GrowingStream file)
      : recording_(std::move(recording)), file_(std::move(file)) {}
  void begin_text(bool truth);
  std::optional<std::size_t> cell_of_truth() const;

  Recording recording_;
  host::GrowingStream file_;
  std::string line_;
  std::size_t samples_ = 0;
  bool begun_ = false;       // the heading is written
  bool truth_lost_ = false;  // a later sample has none: the column is cut out at the end
};

}  // namespace capsoc::metrics
