#include "observers/sensors_observation.h"

#include <algorithm>
#include <utility>

#include "capsoc_registers.h"
#include "coprocessor/sequencer.h"

namespace capsoc::run {
namespace {

/// One held for each channel, and one in each stage.
constexpr std::size_t most_taken = coprocessor::most_channels + coprocessor::stage_count;

}  // namespace

metrics::CoprocessorResult result_of(const coprocessor::Nodes& nodes) {
  metrics::CoprocessorResult r;
  r.angle = static_cast<uint32_t>(nodes.angle);
  r.angle_valid = (nodes.status & registers::coprocessor::STATUS_VALID_mask) != 0;
  r.words = {static_cast<int32_t>(nodes.a1),    static_cast<int32_t>(nodes.a2),
             static_cast<int32_t>(nodes.b1),    static_cast<int32_t>(nodes.b2),
             static_cast<uint32_t>(nodes.beta), static_cast<uint32_t>(nodes.phi)};
  return r;
}

SensorsObservation::SensorsObservation(const RunInputs& inputs) : inputs_(inputs) {
  for (metrics::Metrics& each : inputs.metrics_of_each()) sensors_.push_back({std::move(each)});
}

void SensorsObservation::taken(uint64_t number, unsigned channel,
                               const metrics::SensorTruth& truth) {
  if (on_the_way_.size() == most_taken) on_the_way_.pop_front();
  on_the_way_.push_back({number, channel, truth});
}

/// The results of a channel come in the order of its samples.
void SensorsObservation::result(const coprocessor::Nodes& nodes, uint64_t number) {
  const auto mine = std::find_if(on_the_way_.begin(), on_the_way_.end(),
                                 [number](const Sample& each) { return each.number == number; });
  if (mine == on_the_way_.end()) return;  // software wrote it
  Sensor& sensor = sensors_.at(mine->channel);
  metrics::CoprocessorResult r = result_of(nodes);
  r.demodulating = true;        // as far as is known: a turn of angles is kept
  r.numeric_reference = false;  // phi has nothing to be compared with
  sensor.metrics.accepted(mine->truth);
  sensor.metrics.result(r);
  sensor.valid += r.angle_valid ? 1 : 0;
  on_the_way_.erase(mine);
}

std::vector<SensorResult> SensorsObservation::results() const {
  std::vector<SensorResult> results;
  for (const Sensor& sensor : sensors_) {
    const std::size_t channel = results.size();
    const metrics::Metrics& m = sensor.metrics;
    results.push_back(
        {channel == 0 ? inputs_.sensor_file : inputs_.further_sensors.at(channel - 1).file,
         m.samples(), sensor.valid, m.words(), m.truth(), m.angle_errors()});
  }
  return results;
}

void SensorsObservation::Sample::visit(Archive& archive) {
  archive("number", number);
  archive("channel", channel);
  archive("truth", truth);
}

void SensorsObservation::Sensor::visit(Archive& archive) {
  archive("metrics", metrics);
  archive("valid", valid);
}

void SensorsObservation::visit(Archive& archive) {
  for (Sensor& each : sensors_) archive("sensor", each);
  archive.sequence("on_the_way", on_the_way_, most_taken);
  if (!archive.loading()) return;
  const bool known =
      std::all_of(on_the_way_.begin(), on_the_way_.end(),
                  [this](const Sample& each) { return each.channel < sensors_.size(); });
  if (!known) archive.refuse("has a sample of a channel without a sensor");
}

}  // namespace capsoc::run
