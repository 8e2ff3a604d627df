#include "fit/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "golden/trace.h"
#include "peripherals/quantiser.h"
#include "support/constants.h"

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

struct Columns {
  Eigen::ArrayXd u, v, angle;  ///< without a true angle the last is empty
};

/// At most `count` samples, each kept once.
Columns convert(sensor::Source& source, uint64_t count, unsigned bits) {
  const double rate = source.description().sample_rate_hz.value_or(250);
  const auto size = static_cast<Eigen::Index>(count);
  Columns columns{Eigen::ArrayXd(size), Eigen::ArrayXd(size), Eigen::ArrayXd()};
  bool has_angle = true;
  Eigen::Index k = 0;
  for (; k < size; ++k) {
    const auto value = source.sample(static_cast<uint64_t>(k), static_cast<double>(k) / rate);
    if (!value) break;
    columns.u[k] = converted(value->u, bits);
    columns.v[k] = converted(value->v, bits);
    has_angle = has_angle && value->has_truth;
    if (!has_angle) continue;
    if (k == 0) columns.angle.resize(size);
    columns.angle[k] = 2 * pi * value->angle_turns;
  }
  if (!has_angle) columns.angle.resize(0);
  for (Eigen::ArrayXd* column : {&columns.u, &columns.v, &columns.angle})
    if (column->size() > k) column->conservativeResize(k);
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

  Columns columns = convert(*trace.source, std::min(count, length), record.adc_bits);
  record.samples = {std::move(columns.u), std::move(columns.v)};
  record.angle = std::move(columns.angle);
  return record;
}

}  // namespace capsoc::fit
