#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "sensor/recording_options.h"
#include "sensor/sample_column.h"
#include "sensor/source.h"

namespace capsoc::sensor {

/// A record: sample k is row k, whatever its time; the front-end's sample clock should run at
/// description().sample_rate_hz, when that is known.
class RecordedSource final : public Source {
 public:
  /// `u` and `v` in units of full scale; `angle`, in turns in [0, 1), is empty without truth.
  RecordedSource(Description description, SampleColumn u, SampleColumn v, SampleColumn angle);

  std::optional<SensorValue> sample(uint64_t k, double t_seconds) override;
  void rewind() override {}
  const Description& description() const override { return description_; }

  /// The columns, for what needs all samples at once; taking them leaves the source empty.
  SampleColumn& u() { return u_; }
  SampleColumn& v() { return v_; }
  SampleColumn& angle() { return angle_; }

 private:
  Description description_;
  SampleColumn u_, v_, angle_;
};

/// Reads a recording that is text (traces/README.md has the dialects): one row a sample, the
/// columns by name or as `options` say. `file` is only used in error sentences: "file:line: what is
/// wrong; what to do".
Result<RecordedSource> read_recording(std::string_view text, const std::string& file,
                                      const RecordingOptions& options = {});

}  // namespace capsoc::sensor
