// What a run sees of the sensor and of the coprocessor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "metrics/metrics.h"
#include "metrics/sample_record.h"
#include "metrics/sensor_match.h"
#include "run/progress.h"
#include "sensor/load.h"
#include "soc/soc.h"

namespace capsoc::run {

/// The sensor, the coprocessor's results and the metrics wired together.
class Observation {
 public:
  /// `recording`: the samples are kept as the coprocessor saw them.
  Observation(soc::Soc& soc, sensor::Source& source, metrics::Metrics& metrics,
              metrics::SensorMatch& match, Progress& progress, bool recording);
  Observation(const Observation&) = delete;
  Observation& operator=(const Observation&) = delete;

  const metrics::SampleRecord& recorded() const { return recorded_; }

  /// What is on its way; what was recorded is the host's.
  void visit(kit::Archive& archive);

 private:
  void record();
  std::optional<peripherals::AdcInput> next(uint64_t k, double t);
  void result(const coprocessor::Nodes& nodes);
  void watch_sampling(uint32_t control);
  double sensor_time(uint64_t k, double t) const;
  void keep(const metrics::CoprocessorResult& result, const coprocessor::Nodes& nodes);

  soc::Soc& soc_;
  sensor::Source& source_;
  metrics::Metrics& metrics_;
  metrics::SensorMatch& match_;
  Progress& progress_;
  metrics::SensorTruth truth_;
  bool recording_;
  std::size_t finished_ = 0;           ///< of those recorded; the next result belongs to this one
  metrics::RecordedSample converted_;  ///< the newest of the front-end
  double recording_since_s_ = 0;
  metrics::SampleRecord recorded_;
  kit::Listening samples_, results_, conversions_;
};

}  // namespace capsoc::run
