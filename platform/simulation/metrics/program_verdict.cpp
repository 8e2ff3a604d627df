#include "metrics/program_verdict.h"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "base/constants.h"
#include "base/printable.h"

namespace capsoc::metrics {
namespace {

enum State : uint32_t { none, pass, fail };
enum Condition : uint32_t { no_sample_is_stale = 1, harmonics_are_small = 2 };

/// Layouts of the object; host and guest are little-endian.
struct Object {
  static constexpr uint32_t magic = 0x32524556;
  uint32_t state, bound, samples, motion, unseen, conditions;
  std::array<char, 160> reason;
};
static_assert(sizeof(Object) == 184);
/// That of programs built before the claim was part of it.
struct FirstObject {
  static constexpr uint32_t magic = 0x31524556;
  uint32_t state, bound;
  std::array<char, 96> reason;
};
static_assert(sizeof(FirstObject) == 104);

double degrees(uint32_t angle) {
  return angle / q32 * 360;
}

template <std::size_t size>
std::string text_of(const std::array<char, size>& reason) {
  const std::string_view text(reason.data(), reason.size());
  return printable(text.substr(0, text.find('\0')), reason.size());
}

ProgramVerdict verdict_of(const FirstObject& object) {
  ProgramVerdict verdict;
  verdict.pass = object.state == State::pass;
  if (verdict.pass)
    verdict.bound_deg = degrees(object.bound);
  else
    verdict.reason = text_of(object.reason);
  return verdict;
}

ProgramVerdict verdict_of(const Object& object) {
  ProgramVerdict verdict;
  verdict.pass = object.state == State::pass;
  if (!verdict.pass) {
    verdict.reason = text_of(object.reason);
    return verdict;
  }
  verdict.bound_deg = degrees(object.bound);
  if (object.samples != 0) verdict.samples = object.samples;
  if (object.motion != 0) verdict.motion_deg = degrees(object.motion);
  if ((object.conditions & no_sample_is_stale) != 0)
    verdict.conditions.emplace_back("no sample is stale");
  if ((object.conditions & harmonics_are_small) != 0)
    verdict.conditions.push_back(
        fmt::format("harmonics along the circle stay below {:.2f} deg", degrees(object.unseen)));
  return verdict;
}

/// Nothing if there is no object of this layout, or no verdict in it.
template <typename Layout>
std::optional<ProgramVerdict> read_as(uint32_t address, const ReadMemory& read) {
  Layout object{};
  if (!read(address + sizeof(uint32_t), &object, sizeof object)) return std::nullopt;
  if (object.state != State::pass && object.state != State::fail) return std::nullopt;
  return verdict_of(object);
}

}  // namespace

std::optional<ProgramVerdict> read_verdict(const loader::ElfImage& program, const ReadMemory& read,
                                           const Metrics& metrics) {
  const auto address = program.address_of("program_verdict");
  uint32_t magic = 0;
  if (!address || !read(*address, &magic, sizeof magic)) return std::nullopt;
  std::optional<ProgramVerdict> verdict;
  if (magic == Object::magic) verdict = read_as<Object>(*address, read);
  if (magic == FirstObject::magic) verdict = read_as<FirstObject>(*address, read);
  if (!verdict) return std::nullopt;
  const AngleErrors errors = metrics.angle_errors();
  if (verdict->samples)
    verdict->largest_error_deg = metrics.largest_error_of_last(*verdict->samples);
  else
    verdict->largest_error_deg = errors.calibration_mode_max
                                     ? errors.calibration_mode_max
                                     : errors.calibrated_max_last_revolution;
  return verdict;
}

}  // namespace capsoc::metrics
