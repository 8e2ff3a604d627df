// Observation of the sensor and of the coprocessor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "inputs/run_inputs.h"
#include "kit/probe.h"
#include "metrics/metrics.h"
#include "metrics/sample_record.h"
#include "metrics/sensor_match.h"
#include "observers/progress.h"
#include "observers/run_observer.h"
#include "observers/sensors_observation.h"
#include "soc/soc.h"

namespace capsoc::run {

/// The sensor, the coprocessor's results and the metrics wired together.
class Observation final : public RunObserver {
 public:
  /// `on_terminal`: the progress is shown on standard error.
  Observation(soc::Soc& soc, const RunInputs& inputs, bool on_terminal);

  metrics::SampleProbe samples;

  const metrics::Metrics& metrics() const { return metrics_; }
  /// Number of the sensor's newest sample, from 1; 0: none yet.
  uint64_t sample_number() const { return number_; }

  std::optional<Error> open() override;
  /// Saves or loads samples on their way to their results, with or without listeners. Data that
  /// listeners keep on the host is not part of it.
  void visit(Archive& archive) override;
  void close(RunResult& result) override;
  void finish(RunResult& result) override;

 private:
  void warn(const std::string& sentence);
  /// A sample between its source and its result.
  struct Sample {
    uint64_t number = 0;  ///< from 1, over all starts of the sensor
    metrics::RecordedSample recorded;

    void visit(Archive& archive);
  };

  void converted(const peripherals::SensorSample& sample);
  void take(uint64_t number);
  void lose(std::size_t count);
  std::optional<peripherals::AdcInput> next(uint64_t k, double t);
  std::optional<peripherals::AdcInput> next_of(unsigned channel, uint64_t k, double t);
  /// With several sensors the metrics are those of `several_`.
  bool is_alone() const { return !several_; }
  void result(const coprocessor::Nodes& nodes, uint64_t number);
  void watch_sampling(uint32_t control);
  double sensor_time(uint64_t k, double t) const;
  void give(uint64_t number, const metrics::CoprocessorResult& result,
            const coprocessor::Nodes& nodes);

  soc::Soc& soc_;
  const RunInputs& inputs_;
  sensor::Source& source_;
  metrics::Metrics metrics_;
  std::vector<std::string> warnings_;  ///< where the program does not match the sensor
  metrics::SensorMatch match_;
  Progress progress_;
  metrics::SensorTruth truth_;  ///< of the newest sample
  unsigned channel_ = 0;        ///< ditto
  std::optional<SensorsObservation> several_;
  uint64_t number_ = 0;            ///< of the newest sample
  Sample newest_;                  ///< of the front-end
  std::optional<double> since_s_;  ///< the first sample that the coprocessor took
  std::deque<Sample> on_the_way_;
  kit::Listening submissions_, results_, conversions_;
};

}  // namespace capsoc::run
