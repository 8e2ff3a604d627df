#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sensor/source.h"
#include "support/result.h"

namespace capsoc::sensor {

/// A record: sample k is row k, whatever its time; the front-end's sample clock should run at
/// description().sample_rate_hz, when that is known.
class RecordedSource final : public Source {
 public:
  struct Row {
    double u, v;
    double angle_turns;  ///< in [0, 1), 0 without truth
  };

  RecordedSource(Description description, std::vector<Row> rows, bool has_truth);

  std::optional<SensorValue> sample(uint64_t k, double t_seconds) override;
  void rewind() override {}
  const Description& description() const override { return description_; }

 private:
  Description description_;
  std::vector<Row> rows_;
  bool has_truth_;
};

/// Reads a CSV record: a header row, then one row a sample. Columns by name, in any order: `u` and
/// `v` (full scale 1), optionally `angle_deg` (true angle in degrees, any number of turns) and `t`
/// (seconds, increasing; gives the sample rate). Other columns are ignored. Empty lines and lines
/// that start with '#' do not count; CR LF is a line end. `file` is only used in error sentences.
Result<RecordedSource> read_recording(std::string_view text, const std::string& file);

}  // namespace capsoc::sensor
