// One fit: a trace in, the calibration of its sensor out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/record.h"
#include "identification/error_curve.h"
#include "identification/identify.h"
#include "metrics/metrics.h"

namespace capsoc::fit {

struct FitOptions {
  RecordOptions record;
  identification::IdentifyOptions identify;
  bool all_methods = false;  ///< the other methods, too, for the table
  bool use_angle = false;    ///< an error table from the recorded true angle
};

/// What one method made of the samples.
struct Attempt {
  std::string method;                                    ///< its name
  std::optional<identification::Parameters> parameters;  ///< nothing: see error
  std::string error;
  double loss = 0;                        ///< mean of (1 - Y)^2
  int iterations = 0;                     ///< 0 for the closed forms
  std::string stopped;                    ///< empty for the closed forms
  double difference = 0;                  ///< from the answer, as in identification::Companion
  std::optional<double> angle_error_deg;  ///< peak to peak, where the true angle is known
};

/// Peak-to-peak errors of the angle against the truth over the record, degrees. Peak to peak as the
/// CSFN paper counts: a constant is not an error, since the samples do not tell where 0 is.
struct AngleErrors {
  std::optional<double> uncalibrated;    ///< of atan2(U, V)
  std::optional<double> calibrated;      ///< with the five parameters
  std::optional<double> with_harmonics;  ///< with the harmonics taken off; only if identified
};

struct Fit {
  Record record;
  identification::Identification answer;
  /// Why there is no calibration: samples that no ellipse can be put through (too few, a point, a
  /// straight line), the reason of the gate that rejected it, or parameters that the
  /// registers cannot hold. Empty: there is one.
  std::string rejection;
  metrics::ParameterWords words;                    ///< phi is 0
  std::optional<identification::Parameters> truth;  ///< canonical
  AngleErrors errors;
  /// One sentence when the true angle of the record does not turn with its signals: it is not used
  /// then. Empty otherwise.
  std::string angle_column;
  /// With FitOptions::use_angle: the table, or why there is none.
  std::optional<identification::ErrorCurve> error_curve;
  std::vector<Attempt> attempts;  ///< with FitOptions::all_methods: all, the answer's first, the
                                  ///< papers' other methods (peers.h) last
};

/// Error: the trace cannot be read, an option is out of range, or use_angle without a column of
/// true angles. A record that is rejected is no error: see Fit::rejection.
Result<Fit> fit(const std::string& trace, const FitOptions& options);

}  // namespace capsoc::fit
