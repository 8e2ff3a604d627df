#pragma once

#include <cstdint>
#include <optional>

#include "coprocessor/types.h"
#include "identification/samples.h"
#include "sensor/signal_config.h"

namespace capsoc::accuracy {

/// One run of the coprocessor model, learning all the time, on a described signal.
struct Experiment {
  sensor::SignalConfig signal;  ///< its adc_bits is the converter's width
  double reference_hz = 0.05;   ///< the frequency word's rate, negative: reversed
  coprocessor::ReferenceSource source = coprocessor::ReferenceSource::numeric;
  std::optional<double> step;  ///< 2mu of all six weights; absent: the reset value
  /// Learns by blocks of a turn of the reference, from coefficients of 0 (numeric, `precise`).
  bool blocks = false;
  double duration_s = 400.0;
  double window_s = 20.0;  ///< the end over which the error is taken; one revolution at 0.05 Hz
};

struct Outcome {
  double error_deg = 0.0;  ///< largest |ANGLE - true angle| within the window.
  /// From here on a1, a2, b1, b2 and beta stay within 1 %; absent: not at the end. phi is left out:
  /// with the angle source it is not observable.
  std::optional<double> settled_s;
  bool clipped = false;                   ///< the signal left the converter's range at least once
  identification::Parameters parameters;  ///< at the end, as in the registers
};

struct Comparison {
  Outcome precise;
  Outcome paper;
};

Outcome run(const Experiment& experiment, coprocessor::Arithmetic arithmetic);

/// Both arithmetics at the same time.
Comparison compare(const Experiment& experiment);

}  // namespace capsoc::accuracy
