#include "fit/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.h"
#include "golden/trace.h"
#include "peripherals/quantiser.h"
#include "sensor/recorded_source.h"
#include "sensor/sample_column.h"

namespace capsoc::fit {
namespace {

constexpr uint64_t samples_of_endless = 100'000;  // the main job's
constexpr uint64_t largest_record = 100'000'000;  // 2.4 GB

double largest_value(unsigned bits) {
  return 1 - std::ldexp(1.0, 1 - static_cast<int>(bits));
}

/// A converter of 32 bits is an ideal one here: the papers' simulations have none.
double converted(double value, unsigned bits) {
  if (bits < 32) return peripherals::quantise(value, bits).word / 0x1p31;
  return std::clamp(value, -1.0, largest_value(bits));
}

Eigen::ArrayXd taken(sensor::SampleColumn& column, uint64_t count) {
  const auto size = std::min<std::size_t>(count, column.size());
  Eigen::ArrayXd values(static_cast<Eigen::Index>(size));
  column.take(values.data(), size);
  return values;
}

/// A recording's columns move, so that ten million samples are in memory once.
void take_columns(sensor::RecordedSource& source, uint64_t count, Record& record) {
  record.samples.u = taken(source.u(), count);
  record.samples.v = taken(source.v(), count);
  record.angle = taken(source.angle(), count);
  for (Eigen::ArrayXd* channel : {&record.samples.u, &record.samples.v})
    for (double& value : *channel) value = converted(value, record.adc_bits);
  for (double& angle : record.angle) angle = 2 * pi * angle;
}

void take_samples(sensor::Source& source, uint64_t count, Record& record) {
  const double rate = source.description().sample_rate_hz.value_or(250);
  sensor::SampleColumn u, v, angle;
  bool has_angle = true;
  for (uint64_t k = 0; k < count; ++k) {
    const auto value = source.sample(k, static_cast<double>(k) / rate);
    if (!value) break;
    u.push_back(converted(value->u, record.adc_bits));
    v.push_back(converted(value->v, record.adc_bits));
    angle.push_back(2 * pi * value->angle_turns);
    has_angle = has_angle && value->has_truth;
  }
  record.samples = {taken(u, count), taken(v, count)};
  if (has_angle) record.angle = taken(angle, count);
}

/// The converter is the one that took the recording, where the values show its step.
void take_step(Record& record) {
  if (record.adc_bits < 32) {
    record.step = std::ldexp(1.0, 1 - static_cast<int>(record.adc_bits));
    return;
  }
  record.step = record.description.step.value_or(0);
  record.full_scale = record.step > 0 ? 1 - record.step : record.full_scale;
}

}  // namespace

Result<Record> read_record(const std::string& path, const RecordOptions& options) {
  auto opened = golden::open_trace(path, options.keys, options.recording);
  if (!opened) return Error{opened.error()};
  const golden::Trace& trace = opened.value();
  Record record;
  record.path = path;
  record.sha256 = trace.sha256;
  record.description = trace.source->description();
  record.adc_bits = options.adc_bits != 0
                        ? options.adc_bits
                        : static_cast<unsigned>(record.description.adc_bits.value_or(32));
  record.full_scale = largest_value(record.adc_bits);
  const uint64_t length = record.description.samples.value_or(samples_of_endless);
  const uint64_t count = options.samples != 0 ? options.samples : length;
  if (std::min(count, length) > largest_record)
    return Error{fmt::format("{}: {} samples are too many; give --samples with at most {}",
                             trace.name, length, largest_record)};

  record.warnings = golden::warnings_of(trace);
  if (auto* recorded = dynamic_cast<sensor::RecordedSource*>(trace.source.get()))
    take_columns(*recorded, count, record);
  else
    take_samples(*trace.source, count, record);
  take_step(record);
  return record;
}

}  // namespace capsoc::fit
