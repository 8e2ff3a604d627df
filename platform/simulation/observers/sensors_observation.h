// What becomes of each of several sensors (coprocessor.channels).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "base/archive.h"
#include "coprocessor/nodes.h"
#include "inputs/run_inputs.h"
#include "metrics/metrics.h"
#include "results/results.h"

namespace capsoc::run {

/// What the nodes say of a result: the angle, whether it is valid, and the parameters.
metrics::CoprocessorResult result_of(const coprocessor::Nodes& nodes);

/// Angle errors and parameters by channel. The mode of a channel is in registers that only the
/// program can open (CHANNEL.WINDOW), so the errors are those of all angles with VALID.
class SensorsObservation {
 public:
  explicit SensorsObservation(const RunInputs& inputs);

  /// The sensors begin again: samples on their way are dropped.
  void restarted() { on_the_way_.clear(); }
  /// The coprocessor took a sample.
  void taken(uint64_t number, unsigned channel, const metrics::SensorTruth& truth);
  /// `number`: of the sample.
  void result(const coprocessor::Nodes& nodes, uint64_t number);
  void visit(Archive& archive);
  std::vector<SensorResult> results() const;

 private:
  struct Sample {
    uint64_t number = 0;
    unsigned channel = 0;
    metrics::SensorTruth truth;

    void visit(Archive& archive);
  };
  struct Sensor {
    metrics::Metrics metrics;
    uint64_t valid = 0;

    void visit(Archive& archive);
  };

  const RunInputs& inputs_;
  std::vector<Sensor> sensors_;
  std::deque<Sample> on_the_way_;  ///< in order; a reset loses some
};

}  // namespace capsoc::run
