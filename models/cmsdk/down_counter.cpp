#include "cmsdk/down_counter.h"

#include <algorithm>

namespace capsoc::cmsdk {

uint64_t DownCounter::steps_until(uint64_t cycle) const {
  return running_ && cycle > anchor_ ? (cycle - anchor_) / divisor_ : 0;
}

uint32_t DownCounter::value_at(uint64_t cycle) const {
  const uint64_t steps = steps_until(cycle);
  if (steps <= value_) return static_cast<uint32_t>(value_ - steps);
  if (one_shot || reload == 0) return 0;
  const uint64_t period = uint64_t{reload} + 1;
  return static_cast<uint32_t>(reload - (steps - value_ - 1) % period);
}

uint64_t DownCounter::next_zero() const {
  if (!running_) return never;
  if (value_ != 0) return anchor_ + uint64_t{value_} * divisor_;
  if (one_shot || reload == 0) return never;
  return anchor_ + (uint64_t{reload} + 1) * divisor_;
}

bool DownCounter::advance(uint64_t cycle) {
  if (cycle <= present_) return false;
  const bool reached_zero = next_zero() <= cycle;
  value_ = value_at(cycle);
  anchor_ = running_ ? anchor_ + steps_until(cycle) * divisor_ : cycle;
  present_ = cycle;
  return reached_zero;
}

void DownCounter::set_value(uint32_t value) {
  value_ = value;
  anchor_ = present_;
}

void DownCounter::set_divisor(uint32_t divisor) {
  if (divisor == divisor_) return;
  divisor_ = divisor;
  anchor_ = present_;
}

void DownCounter::start() {
  if (!running_) anchor_ = present_;
  running_ = true;
}

void DownCounter::visit(Archive& archive, uint64_t now) {
  archive("reload", reload);
  archive("one_shot", one_shot);
  archive("present", present_);
  archive("anchor", anchor_);
  archive("value", value_);
  archive("divisor", divisor_);
  archive("running", running_);
  if (divisor_ == 0) archive.refuse("has a counter that divides by 0");
  if (present_ > now || anchor_ > present_) archive.refuse("has a counter ahead of time");
}

}  // namespace capsoc::cmsdk
