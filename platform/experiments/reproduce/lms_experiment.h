#pragma once

#include <optional>
#include <vector>

#include "identification/lms_reference.h"
#include "sensor/signal_config.h"

namespace capsoc::reproduce {

/// One run of the double-precision LMSED over a record, as in the SoC paper's section 4.1.
struct Experiment {
  sensor::SignalConfig signal;  ///< its motion's frequency is also the reference's
  identification::lms::Steps steps;
  identification::lms::Gain gain = identification::lms::Gain::without_factor_two;
  double duration_s = 400.0;
};

/// Largest |angle error| in degrees. `calibrated` uses the parameters of the run's end for every
/// sample; phi is taken off as Eq (5) has it: angle - phi_hat against omega k.
struct Outcome {
  identification::lms::Parameters parameters;  ///< at the end
  std::optional<double> first_within_s;        ///< all parameters within 1 % for the first time
  std::optional<double> first_amplitudes_s;    ///< a1 and a2 alone
  std::optional<double> first_amplitudes_offsets_s;  ///< a1, a2, b1, b2
  std::optional<double> stays_within_s;              ///< within 1 % from here to the end
  double uncalibrated = 0.0;                         ///< atan2(U, V) against omega k: contains phi
  double uncalibrated_to_truth = 0.0;                ///< against omega k + phi
  double calibrated = 0.0;
  double calibrated_start = 0.0;  ///< within the first 20 s
  double online_end = 0.0;        ///< with the parameters of each moment, last 20 s
};

Outcome run(const Experiment& experiment);

/// The parameters at these times after the start, in order, all before the experiment's end.
std::vector<identification::lms::Parameters> learning_curve(const Experiment& experiment,
                                                            const std::vector<double>& times_s);

}  // namespace capsoc::reproduce
