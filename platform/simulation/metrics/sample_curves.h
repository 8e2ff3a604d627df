// What the samples of a run look like when they are drawn: the curves of a report.
#pragma once

#include <optional>
#include <vector>

#include "base/curve.h"
#include "metrics/last_turn.h"
#include "metrics/metrics.h"
#include "metrics/sample_record.h"

namespace capsoc::metrics {

/// Gathers them while the run continues, in memory that does not grow with it.
///
/// Curves by name, thinned so that no spike is lost; one without a point is left out. x is the time
/// since the first sample in seconds unless said otherwise; angles are in degrees.
/// - `a1` .. `phi`: the parameters (full scale, rad); `err_u`, `err_v`, `error_average`
/// - `angle_error`, `raw_error`: of the coprocessor's angle and of atan2(U, V), where the true one
///   is known and the coprocessor's is valid
/// - `lissajous`, `calibrated`: V over U of the last turn, and the same by the parameters of `end`
/// - `error_by_angle`, `raw_by_angle`: the errors of that turn over the true angle
/// - `spectrum`, `raw_spectrum`: their amplitude by harmonic of the true angle, 0 .. 16
/// - `status.NAME`, `flags.NAME`: the bit of the register when it was once set, 0 or 1, a point for
///   each change
class SampleCurves {
 public:
  SampleCurves();

  /// In the order in which they came.
  void add(const RecordedSample& sample);

  /// What was gathered until now.
  void visit(Archive& archive);

  Curves curves(const ParameterWords& end) const;

 private:
  void add_bits(double time_s, const RecordedResult& result);

  Thinner values_;  // of each result
  Thinner angle_error_, raw_error_;
  LastTurn turn_;
  std::vector<Thinner> changes_;          // of each bit
  std::optional<RecordedResult> change_;  // the newest with one
  double last_s_ = 0;                     // of the newest result
};

}  // namespace capsoc::metrics
