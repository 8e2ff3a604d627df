#include "sensor/recording_builder.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/constants.h"
#include "base/printable.h"
#include "sensor/motion.h"
#include "sensor/text.h"

namespace capsoc::sensor {
namespace {

std::string options_of(const UnitGuess& guess) {
  std::string text = fmt::format("--full-scale {}", guess.full_scale);
  if (guess.zero != 0) text += fmt::format(" --zero {}", guess.zero);
  return text;
}

}  // namespace

RecordingBuilder::RecordingBuilder(std::string file, const RecordingOptions& options,
                                   const ColumnChoice& choice)
    : file_(std::move(file)),
      options_(options),
      choice_(choice),
      has_angle_(choice.has(role_angle)),
      has_time_(choice.has(role_time)),
      least_angle_(std::numeric_limits<double>::infinity()),
      most_angle_(-std::numeric_limits<double>::infinity()) {
  description_.name = base_name(file_);
  description_.origin = "recording";
  description_.motion = MotionKind::recorded;
}

Error RecordingBuilder::error(const std::string& message) const {
  return Error{file_ + ": " + message};
}

/// Scales full scale to 1. A unit that the user gives takes precedence; without one the values must
/// already be in units of a converter's full scale.
std::optional<Error> RecordingBuilder::scale() {
  UnitGuess unit{"", options_.full_scale.value_or(1), options_.zero.value_or(0)};
  if (options_.automatic_scale) unit = guess_unit(range_, choice_.value_unit);
  const auto in_unit = [&unit](double value) { return (value - unit.zero) / unit.full_scale; };
  const bool plain = unit.full_scale == 1 && unit.zero == 0;
  if (!plain) {
    u_.transform(in_unit);
    v_.transform(in_unit);
  }
  ValueRange scaled;
  if (plain) {
    scaled = range_;
  } else {
    u_.for_each([&](double value) { scaled.take(value); });
    v_.for_each([&](double value) { scaled.take(value); });
  }
  if (scaled.outside_full_scale()) {
    const UnitGuess guess = guess_unit(range_, choice_.value_unit);
    const std::string values = fmt::format("values {:.6g}..{:.6g}", range_.least, range_.most);
    if (options_.full_scale || options_.zero)
      return error(
          fmt::format("{} with --full-scale {} --zero {} reach {:.3g} of full scale; for {} "
                      "use {}, or --scale auto",
                      values, unit.full_scale, unit.zero,
                      std::max(std::fabs(scaled.least), std::fabs(scaled.most)), guess.name,
                      options_of(guess)));
    return error(fmt::format("{} lie outside full scale (-1..1): {}? Use {}, or --scale auto",
                             values, guess.name, options_of(guess)));
  }
  description_.unit = unit.name;
  description_.full_scale = unit.full_scale;
  description_.zero = unit.zero;
  description_.step = common_step(u_, v_);
  return std::nullopt;
}

/// The file's unit becomes turns. A name without a unit is judged by its range: degrees go beyond
/// a turn of radians.
std::optional<Error> RecordingBuilder::turn_angles() {
  if (!has_angle_) return std::nullopt;
  AngleUnit unit = choice_.angle;
  const double largest = std::max(std::fabs(least_angle_), std::fabs(most_angle_));
  if (unit == AngleUnit::unknown && largest > 2.02 * pi) unit = AngleUnit::degrees;
  if (unit == AngleUnit::unknown && most_angle_ - least_angle_ > 1.5 * pi)
    unit = AngleUnit::radians;
  if (unit == AngleUnit::unknown)
    return error(
        fmt::format("column '{0}' goes from {1:.6g} to {2:.6g}: degrees, radians or turns? "
                    "Name it angle_deg, angle_rad or angle_turns, or choose with "
                    "--columns T,U,V,{0}:rad",
                    printable(choice_.angle_name), least_angle_, most_angle_));
  const double turn = unit == AngleUnit::degrees ? 360 : unit == AngleUnit::radians ? 2 * pi : 1;
  angle_.transform([turn](double angle) { return modulo_turn(angle / turn); });
  return std::nullopt;
}

Result<RecordedSource> RecordingBuilder::finish() {
  description_.samples = rows();
  if (has_time_) {
    TimeStamps::Verdict times = stamps_.verdict();
    if (!times.error.empty()) return error_at(file_, times.line, times.error);
    description_.sample_rate_hz = times.rate_hz;
    for (std::string& sentence : times.remarks) remark(std::move(sentence));
  }
  if (rate_hz_) description_.sample_rate_hz = rate_hz_;
  if (auto error = scale()) return *error;
  if (auto error = turn_angles()) return *error;
  return RecordedSource(std::move(description_), std::move(u_), std::move(v_), std::move(angle_));
}

std::string base_name(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

}  // namespace capsoc::sensor
