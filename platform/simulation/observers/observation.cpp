#include "observers/observation.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "capsoc_registers.h"
#include "coprocessor/sequencer.h"
#include "kit/seconds.h"
#include "metrics/truth_alignment.h"

namespace capsoc::run {
namespace {

namespace cop = registers::coprocessor;

/// One held and one in each stage.
constexpr std::size_t most_on_the_way = 1 + coprocessor::stage_count;

}  // namespace

Observation::Observation(soc::Soc& soc, const RunInputs& inputs, bool on_terminal)
    : soc_(soc),
      inputs_(inputs),
      source_(*inputs.source),
      metrics_(inputs.make_metrics()),
      match_(inputs.sensor_file, inputs.source->description(), inputs.recorded_speed,
             [this](const std::string& sentence) { warn(sentence); }),
      progress_(on_terminal) {
  if (!inputs.further_sensors.empty()) several_.emplace(inputs);
}

void Observation::warn(const std::string& sentence) {
  spdlog::warn("{}", sentence);
  warnings_.push_back(sentence);
}

std::optional<Error> Observation::open() {
  for (const std::string& sentence : inputs_.sensor_warnings) warn(sentence);
  soc_.adc.set_source([this](uint64_t k, double t) { return next(k, t); });
  // Its edge comes before the next sample, so the truth is still this sample's.
  submissions_ = soc_.coprocessor.samples.listen([this](uint64_t, bool latched, uint64_t number) {
    if (!latched) return;
    if (!is_alone()) return several_->taken(number, channel_, truth_);
    metrics_.accepted(truth_);
    take(number);
  });
  results_ = soc_.coprocessor.results.listen(
      [this](uint64_t, const coprocessor::Nodes& nodes, uint64_t number) {
        if (!is_alone()) return several_->result(nodes, number);
        result(nodes, number);
      });
  conversions_ =
      soc_.adc.conversions.listen([this](uint64_t, const peripherals::SensorSample& sample) {
        if (is_alone()) converted(sample);
      });
  return std::nullopt;
}

void Observation::converted(const peripherals::SensorSample& sample) {
  newest_ = {sample.number,
             {kit::to_seconds(sc_core::sc_time_stamp()),
              sample.u,
              sample.v,
              truth_.angle_turns,
              truth_.has_truth,
              {},
              sample.number}};
}

/// The coprocessor takes a sample a cycle after its conversion, before there is a newer one.
void Observation::take(uint64_t number) {
  if (number != newest_.number) return;
  // A reset may lose some again and again.
  if (on_the_way_.size() == most_on_the_way) lose(1);
  if (!since_s_) since_s_ = newest_.recorded.time_s;
  on_the_way_.push_back(newest_);
  on_the_way_.back().recorded.time_s -= *since_s_;
}

/// The oldest, without a result.
void Observation::lose(std::size_t count) {
  for (; count > 0; --count) {
    samples(on_the_way_.front().recorded);
    on_the_way_.pop_front();
  }
}

std::optional<peripherals::AdcInput> Observation::next(uint64_t k, double t) {
  if (k == 0) {
    source_.rewind();
    for (const RunInputs::FurtherSensor& further : inputs_.further_sensors)
      further.source->rewind();
    metrics_.dropped_all();
    if (several_) several_->restarted();
    match_.restarted();
    lose(on_the_way_.size());
  }
  if (!is_alone()) {
    const uint64_t count = 1 + inputs_.further_sensors.size();
    return next_of(static_cast<unsigned>(k % count), k / count, t);
  }
  const auto value = source_.sample(k, t);
  if (!value) return std::nullopt;
  truth_ = {sensor_time(k, t), value->u, value->v, value->angle_turns, value->has_truth};
  return peripherals::AdcInput{value->u, value->v, value->angle_turns, value->has_truth, ++number_};
}

/// The converter takes the sensors in turn.
std::optional<peripherals::AdcInput> Observation::next_of(unsigned channel, uint64_t k, double t) {
  sensor::Source& source = channel == 0 ? source_ : *inputs_.further_sensors.at(channel - 1).source;
  const auto value = source.sample(k, t);
  if (!value) return std::nullopt;
  channel_ = channel;
  truth_ = {t, value->u, value->v, value->angle_turns, value->has_truth};
  return peripherals::AdcInput{value->u,         value->v,  value->angle_turns,
                               value->has_truth, ++number_, channel};
}

double Observation::sensor_time(uint64_t k, double t) const {
  const sensor::Description& description = source_.description();
  const bool recorded = description.motion == sensor::MotionKind::recorded;
  if (!recorded || !description.sample_rate_hz) return t;
  return static_cast<double>(k) / *description.sample_rate_hz;
}

void Observation::watch_sampling(uint32_t control) {
  metrics::SamplingState state;
  const uint32_t both = cop::CTRL_DEMOD_mask | cop::CTRL_ADC_mask;
  state.demodulating = (control & both) == both;  // samples that software feeds have no rate
  const uint32_t reference = (control & cop::CTRL_REF_mask) >> cop::CTRL_REF_shift;
  state.reference = static_cast<metrics::SamplingState::Reference>(reference);
  state.period_cycles = soc_.adc.period.get();
  state.rate_hz = static_cast<double>(soc_.clock.frequency_hz()) / state.period_cycles;
  state.frequency = static_cast<int32_t>(soc_.coprocessor.peek(cop::FREQ_HI_offset));
  match_.result(state);
}

void Observation::result(const coprocessor::Nodes& nodes, uint64_t number) {
  // The observer runs in the cycle of the result, before the firmware can have changed the mode.
  const uint32_t control = soc_.coprocessor.peek(cop::CTRL_offset);
  metrics::CoprocessorResult r = result_of(nodes);
  r.demodulating = (control & cop::CTRL_DEMOD_mask) != 0;
  const uint32_t reference = (control & cop::CTRL_REF_mask) >> cop::CTRL_REF_shift;
  r.numeric_reference = reference == cop::CTRL_REF_numeric;
  r.correcting = (control & cop::CTRL_CORRECT_mask) != 0;
  metrics_.result(r);
  watch_sampling(control);
  give(number, r, nodes);
  progress_.update(kit::to_seconds(sc_core::sc_time_stamp()), r.words);
}

/// Results come in the order of their samples; a soft reset loses some on their way.
void Observation::give(uint64_t number, const metrics::CoprocessorResult& result,
                       const coprocessor::Nodes& nodes) {
  const auto mine =
      std::find_if(on_the_way_.begin(), on_the_way_.end(),
                   [number](const Sample& sample) { return sample.number == number; });
  if (mine == on_the_way_.end()) return;  // software wrote it
  lose(static_cast<std::size_t>(mine - on_the_way_.begin()));
  metrics::RecordedSample& sample = on_the_way_.front().recorded;
  sample.result = {result.angle,
                   result.words,
                   static_cast<int32_t>(nodes.error_u),
                   static_cast<int32_t>(nodes.error_v),
                   static_cast<uint32_t>(nodes.error_average),
                   static_cast<uint32_t>(nodes.status),
                   static_cast<uint32_t>(nodes.flags),
                   result.angle_valid,
                   result.demodulating};
  samples(sample);
  on_the_way_.pop_front();
}

/// It has no result yet.
void Observation::Sample::visit(Archive& archive) {
  archive("number", number);
  archive("time_s", recorded.time_s);
  archive("u", recorded.u);
  archive("v", recorded.v);
  archive("turns", recorded.angle_turns);
  archive("has_truth", recorded.has_truth);
  if (archive.loading()) recorded.number = number;
}

void Observation::visit(Archive& archive) {
  archive("metrics", metrics_);
  archive("truth", truth_);
  archive("number", number_);
  archive("newest", newest_);
  archive("since_s", since_s_);
  archive.sequence("on_the_way", on_the_way_, most_on_the_way);
  archive("sensor_match", match_);
  archive("sensor_warnings", warnings_);
  if (is_alone()) return;
  archive.at_most("channel", channel_, static_cast<unsigned>(inputs_.further_sensors.size()));
  archive("several", *several_);
}

/// No result comes any more.
void Observation::close(RunResult& result) {
  progress_.finish();
  match_.finish();
  if (const auto sentence = metrics::own_zero(inputs_.sensor_file, inputs_.alignment))
    warn(*sentence);
  lose(on_the_way_.size());
  result.sensor_warnings = std::move(warnings_);
}

void Observation::finish(RunResult& result) {
  if (!is_alone()) result.sensors = several_->results();
  result.errors = metrics_.angle_errors();
  result.samples = metrics_.samples();
  result.convergence = metrics_.convergence();
  result.words = metrics_.words();
  result.truth = metrics_.truth();
  result.phi_comparable = metrics_.phi_comparable();
}

}  // namespace capsoc::run
