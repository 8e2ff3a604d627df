#include "metrics/last_turn.h"

#include <cstdlib>

namespace capsoc::metrics {
namespace {

constexpr uint64_t one_turn = uint64_t{1} << 32U;

/// The short way, forwards or back; none next to a sample without a result.
uint64_t way_between(const TurnSample& a, const TurnSample& b) {
  if (!a.has_result || !b.has_result) return 0;
  return static_cast<uint64_t>(std::abs(int64_t{static_cast<int32_t>(b.angle - a.angle)}));
}

}  // namespace

void TurnSample::visit(Archive& archive) {
  archive("angle_turns", angle_turns);
  archive("u", u);
  archive("v", v);
  archive("angle", angle);
  archive("has_result", has_result);
  archive("has_error", has_error);
}

void LastTurn::visit(Archive& archive) {
  archive("samples", samples_);
  archive("enough", enough_);
}

std::size_t LastTurn::length() const {
  uint64_t way = 0;
  std::size_t length = 0;
  while (length < samples_.size() && length < most && (way < one_turn || length < least)) {
    ++length;
    if (length > 1)
      way += way_between(samples_.end()[-static_cast<std::ptrdiff_t>(length)],
                         samples_.end()[1 - static_cast<std::ptrdiff_t>(length)]);
  }
  return length;
}

void LastTurn::forget() {
  const std::size_t kept = length();
  samples_.erase(samples_.begin(), samples_.end() - static_cast<std::ptrdiff_t>(kept));
  enough_ = 2 * kept;
}

}  // namespace capsoc::metrics
