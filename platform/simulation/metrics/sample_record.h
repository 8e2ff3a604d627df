// The samples that the coprocessor saw and what it made of them, kept and written as a recording.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "metrics/metrics.h"
#include "support/result.h"

namespace capsoc::metrics {

/// What the coprocessor's registers and nodes held when a sample's results were committed.
struct RecordedResult {
  uint32_t angle = 0;  ///< 2^-32 turn
  ParameterWords words;
  int32_t error_u = 0, error_v = 0;  ///< Q1.31, of the demodulator
  uint32_t error_average = 0;        ///< Q1.31
  uint32_t status = 0, flags = 0;
  bool angle_valid = false, demodulating = false;
};

/// One sample after quantisation.
struct RecordedSample {
  double time_s = 0;       ///< since the first sample
  int32_t u = 0, v = 0;    ///< Q1.31
  double angle_turns = 0;  ///< true angle; only when has_truth
  bool has_truth = false;
  std::optional<RecordedResult> result = {};  ///< none of a sample that got lost on its way
};

/// Both angles are known, the sensor's and the coprocessor's.
inline bool has_error(const RecordedSample& sample) {
  return sample.has_truth && sample.result && sample.result->angle_valid;
}

/// In the order in which they came. A deque: growing moves nothing, and a long run's megabytes are
/// touched once.
using SampleRecord = std::deque<RecordedSample>;

/// The columns of a recording, in order; positions in a table of all.
using RecordColumns = std::vector<std::size_t>;

/// Names separated by commas; "": t, u, v and angle_deg. The Error for an unknown or repeated one
/// lists all and begins with `origin`.
Result<RecordColumns> record_columns(const std::string& names, const std::string& origin);

/// A recording as `capsoc run` and `capsoc fit` read it (traces/README.md), if u and v are among
/// the columns. angle_deg is left out unless it is known for all samples; other cells without a
/// value are empty. Numbers have all their digits, so that u and v become the same words again in
/// a converter of 32 bits.
std::string to_recording(const SampleRecord& samples, const std::string& origin,
                         const RecordColumns& columns);

}  // namespace capsoc::metrics
