// What a run sees of the sensor and of the coprocessor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "kit/probe.h"
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
  Observation(soc::Soc& soc, sensor::Source& source, metrics::Metrics& metrics,
              metrics::SensorMatch& match, Progress& progress);
  Observation(const Observation&) = delete;
  Observation& operator=(const Observation&) = delete;

  /// Each sample as the coprocessor saw it, in order, once its result is there or cannot come.
  kit::Probe<const metrics::RecordedSample&> samples;

  /// The run is over: no result comes any more.
  void finish() { lose(on_the_way_.size()); }

  /// What is on its way; what listeners keep is the host's.
  void visit(kit::Archive& archive);

 private:
  void take();
  void lose(std::size_t count);
  std::optional<peripherals::AdcInput> next(uint64_t k, double t);
  void result(const coprocessor::Nodes& nodes);
  void watch_sampling(uint32_t control);
  double sensor_time(uint64_t k, double t) const;
  void give(const metrics::CoprocessorResult& result, const coprocessor::Nodes& nodes);

  soc::Soc& soc_;
  sensor::Source& source_;
  metrics::Metrics& metrics_;
  metrics::SensorMatch& match_;
  Progress& progress_;
  metrics::SensorTruth truth_;
  metrics::RecordedSample converted_;  ///< the newest of the front-end
  std::optional<double> since_s_;      ///< the first sample that anybody listened to
  std::deque<metrics::RecordedSample> on_the_way_;
  kit::Listening submissions_, results_, conversions_;
};

}  // namespace capsoc::run
