#include "sensor/recorded_source.h"

#include <utility>

namespace capsoc::sensor {

RecordedSource::RecordedSource(Description description, SampleColumn u, SampleColumn v,
                               SampleColumn angle)
    : description_(std::move(description)),
      u_(std::move(u)),
      v_(std::move(v)),
      angle_(std::move(angle)) {}

std::optional<SensorValue> RecordedSource::sample(uint64_t k, double /*t_seconds*/) {
  if (k >= u_.size()) return std::nullopt;
  SensorValue value;
  value.u = u_[k];
  value.v = v_[k];
  value.has_truth = !angle_.empty();
  if (value.has_truth) value.angle_turns = value.reference_turns = angle_[k];
  return value;
}

}  // namespace capsoc::sensor
