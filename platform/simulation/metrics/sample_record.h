// The samples that the coprocessor saw, its results for them, and the columns of a recording.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "kit/probe.h"
#include "metrics/metrics.h"

namespace capsoc::metrics {

/// What the coprocessor's registers and nodes held when a sample's results were committed.
struct RecordedResult {
  uint32_t angle = 0;  ///< 2^-32 turn
  ParameterWords words;
  int32_t error_u = 0, error_v = 0;  ///< Q1.31, of the demodulator
  uint32_t error_average = 0;        ///< Q1.31
  uint32_t status = 0, flags = 0;
  bool angle_valid = false, demodulating = false;

  void visit(Archive& archive);
};

/// One sample after quantisation.
struct RecordedSample {
  double time_s = 0;       ///< since the first sample
  int32_t u = 0, v = 0;    ///< Q1.31
  double angle_turns = 0;  ///< true angle; only when has_truth
  bool has_truth = false;
  std::optional<RecordedResult> result = {};  ///< none of a sample that got lost on its way
  uint64_t number = 0;                        ///< from 1, over all starts of the sensor
};

/// Both angles are known, the sensor's and the coprocessor's.
inline bool has_error(const RecordedSample& sample) {
  return sample.has_truth && sample.result && sample.result->angle_valid;
}

/// Tells each sample as the coprocessor saw it, in order, once its result is there or cannot come.
using SampleProbe = kit::Probe<const RecordedSample&>;

/// Samples in memory, in the order in which they came; grows with the run. A deque: growing moves
/// nothing. For recordings on disk see sample_writer.h.
using SampleRecord = std::deque<RecordedSample>;

/// The columns of a recording, in order; positions in a table of all.
using RecordColumns = std::vector<std::size_t>;

/// Names separated by commas; "": t, u, v and angle_deg. The Error for an unknown or repeated one
/// lists all and begins with `origin`.
Result<RecordColumns> record_columns(const std::string& names, const std::string& origin);

/// Name of a column as it stands in a recording's heading, for instance "angle_deg".
const char* column_name(std::size_t column);

/// Value of a column for one sample, in the column's unit (docs/reference/results.md); none: an
/// empty cell. Words are whole numbers. `index` counts samples from 0.
std::optional<double> column_value(std::size_t column, const RecordedSample& sample,
                                   std::size_t index);

}  // namespace capsoc::metrics
