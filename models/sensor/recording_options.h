// How a user says what a recording's columns and numbers mean.
#pragma once

#include <optional>
#include <string>

namespace capsoc::sensor {

/// For recordings only; a description has its own keys. The same in `capsoc run` and `capsoc fit`.
struct RecordingOptions {
  /// U,V or T,U,V or T,U,V,ANGLE: names of the header or numbers from 1, each with an optional
  /// ":UNIT" (ms, rad, ...). A T or ANGLE that is empty or "-" is not there. Of two files with a
  /// column each: VALUE or T,VALUE. Empty: the columns are known by their names.
  std::string columns;
  std::optional<double> full_scale;  ///< value that is 1 of full scale; absent: 1
  std::optional<double> zero;        ///< value that is 0 of full scale; absent: 0
  bool automatic_scale = false;      ///< both are guessed from the values

  bool any() const { return !columns.empty() || full_scale || zero || automatic_scale; }
};

}  // namespace capsoc::sensor
