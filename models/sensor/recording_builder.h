// A recording from its rows, whatever file they stand in.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "base/result.h"
#include "sensor/column_roles.h"
#include "sensor/recorded_source.h"
#include "sensor/recording_options.h"
#include "sensor/sample_column.h"
#include "sensor/sample_units.h"
#include "sensor/time_stamps.h"

namespace capsoc::sensor {

/// One row as the file has it, in the file's units; what a recording has not is 0.
struct RawRow {
  double u = 0, v = 0, angle = 0, time = 0;
};

/// Takes rows in order, judges units and time stamps at the end, and makes the source.
class RecordingBuilder {
 public:
  /// `file` begins the sentences.
  RecordingBuilder(std::string file, const RecordingOptions& options, const ColumnChoice& choice);

  void add(const RawRow& row, unsigned long line) {
    range_.take(row.u);
    range_.take(row.v);
    u_.push_back(row.u);
    v_.push_back(row.v);
    if (has_angle_) {
      if (row.angle < least_angle_) least_angle_ = row.angle;
      if (row.angle > most_angle_) most_angle_ = row.angle;
      angle_.push_back(row.angle);
    }
    if (has_time_) stamps_.add(row.time * choice_.time_unit_s, line);
  }
  std::size_t rows() const { return u_.size(); }

  /// The rate that the file itself states, Hz: it stands above that of the time stamps.
  void set_rate(double hz) { rate_hz_ = hz; }

  void remark(std::string sentence) { description_.remarks.push_back(std::move(sentence)); }

  /// Error: one sentence with file and, where there is one, line.
  Result<RecordedSource> finish();

 private:
  std::optional<Error> scale();
  std::optional<Error> turn_angles();
  Error error(const std::string& message) const;

  std::string file_;
  RecordingOptions options_;
  ColumnChoice choice_;
  bool has_angle_, has_time_;
  SampleColumn u_, v_, angle_;
  ValueRange range_;
  double least_angle_, most_angle_;
  TimeStamps stamps_;
  std::optional<double> rate_hz_;
  Description description_;
};

/// The file's name without its folders.
std::string base_name(const std::string& path);

}  // namespace capsoc::sensor
