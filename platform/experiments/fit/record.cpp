#include "fit/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "golden/trace.h"
#include "peripherals/quantiser.h"
#include "support/constants.h"

namespace capsoc::fit {
namespace {

constexpr uint64_t samples_of_endless = 100'000;  // the main job's
constexpr uint64_t largest_record = 100'000'000;  // 2.4 GB

Eigen::ArrayXd to_array(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::ArrayXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

double largest_value(unsigned bits) {
  return 1 - std::ldexp(1.0, 1 - static_cast<int>(bits));
}

/// A converter of 32 bits is an ideal one here: the papers' simulations have none.
double converted(double value, unsigned bits) {
  if (bits < 32) return peripherals::quantise(value, bits).word / 0x1p31;
  return std::clamp(value, -1.0, largest_value(bits));
}

struct Columns {
  std::vector<double> u, v, angle;
  bool has_angle = true;
};

Columns convert(sensor::Source& source, uint64_t count, unsigned bits) {
  const double rate = source.description().sample_rate_hz.value_or(250);
  Columns columns;
  for (uint64_t k = 0; k < count; ++k) {
    const auto value = source.sample(k, static_cast<double>(k) / rate);
    if (!value) break;
    columns.u.push_back(converted(value->u, bits));
    columns.v.push_back(converted(value->v, bits));
    columns.angle.push_back(2 * pi * value->angle_turns);
    columns.has_angle = columns.has_angle && value->has_truth;
  }
  return columns;
}

}  // namespace

Result<Record> read_record(const std::string& path, const RecordOptions& options) {
  auto opened = golden::open_trace(path, options.keys);
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

  const Columns columns = convert(*trace.source, count, record.adc_bits);
  record.samples = {to_array(columns.u), to_array(columns.v)};
  if (columns.has_angle) record.angle = to_array(columns.angle);
  return record;
}

}  // namespace capsoc::fit
