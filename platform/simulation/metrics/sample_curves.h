// What the samples of a run look like when they are drawn: the curves of a report.
#pragma once

#include <vector>

#include "metrics/metrics.h"
#include "metrics/sample_record.h"
#include "support/curve.h"

namespace capsoc::metrics {

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
Curves curves_of(const SampleRecord& samples, const ParameterWords& end);

}  // namespace capsoc::metrics
