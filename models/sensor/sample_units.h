// The unit of a recording's values: what it looks like, and the grid of a converter in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "sensor/sample_column.h"

namespace capsoc::sensor {

/// What is counted of the values of both channels, in the file's unit.
struct ValueRange {
  double least = 0, most = 0;
  bool whole = true;     ///< all are whole numbers
  uint64_t count = 0;    ///< values
  uint64_t outside = 0;  ///< of these, beyond +-1.1

  void take(double value);
  /// A converter ends at full scale, so a record in its unit does not go beyond. Up to a percent of
  /// the values may: outliers of another instrument, which are clipped as the converter would.
  bool outside_full_scale() const;
};

/// A unit that values may be in.
struct UnitGuess {
  std::string name;  ///< "12-bit counts"
  double full_scale = 1, zero = 0;
};

/// The unit that a range of values looks most like. `unit` is what the header says ("mV", "%"), or
/// "". The guess always holds the range.
UnitGuess guess_unit(const ValueRange& range, const std::string& unit);

/// The distance of neighbouring values that all of a channel's are multiples of, apart from one
/// offset: the step of the converter that took them, or of the digits that they were written in.
/// Nothing for fewer than 16 different values, or without such a grid of at most 2^24 steps.
std::optional<double> grid_step(const SampleColumn& channel);

/// The step of both channels, which one converter has taken; nothing where they differ.
std::optional<double> common_step(const SampleColumn& u, const SampleColumn& v);

}  // namespace capsoc::sensor
