#include "metrics/program_verdict.h"

#include <array>
#include <string_view>

#include "support/constants.h"
#include "support/printable.h"

namespace capsoc::metrics {
namespace {

constexpr uint32_t magic = 0x31524556;
enum State : uint32_t { none, pass, fail };

/// The object's layout; host and guest are little-endian.
struct Object {
  uint32_t magic, state, bound;
  std::array<char, 96> reason;
};
static_assert(sizeof(Object) == 108);

}  // namespace

std::optional<ProgramVerdict> read_verdict(const loader::ElfImage& program, const ReadMemory& read,
                                           const AngleErrors& errors) {
  const auto address = program.address_of("program_verdict");
  Object object{};
  if (!address || !read(*address, &object, sizeof object) || object.magic != magic)
    return std::nullopt;
  if (object.state != State::pass && object.state != State::fail) return std::nullopt;
  ProgramVerdict verdict;
  verdict.pass = object.state == State::pass;
  if (verdict.pass) {
    verdict.bound_deg = object.bound / q32 * 360;
  } else {
    const std::string_view reason(object.reason.data(), object.reason.size());
    verdict.reason = printable(reason.substr(0, reason.find('\0')), reason.size());
  }
  verdict.largest_error_deg = errors.calibration_mode_max ? errors.calibration_mode_max
                                                          : errors.calibrated_max_last_revolution;
  return verdict;
}

}  // namespace capsoc::metrics
