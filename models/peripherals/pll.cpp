#include "peripherals/pll.h"

namespace capsoc::peripherals {

bool Pll::legal(uint32_t multiplier, uint32_t divider) {
  const uint64_t scaled = reference_hz * multiplier;
  return divider != 0 && scaled >= minimum_hz * divider && scaled <= maximum_hz * divider;
}

bool Pll::set_ratio(uint32_t multiplier, uint32_t divider) {
  if (!legal(multiplier, divider)) return false;
  if (multiplier == multiplier_ && divider == divider_) return true;
  multiplier_ = multiplier;
  divider_ = divider;
  locked_ = false;
  return true;
}

void Pll::enable(bool on) {
  enabled_ = on;
  locked_ = locked_ && on;
}

uint64_t Pll::output_hz() const {
  return drives_output() ? reference_hz * multiplier_ / divider_ : reference_hz;
}

void Pll::visit(Archive& archive) {
  archive("multiplier", multiplier_);
  archive("divider", divider_);
  archive("enabled", enabled_);
  archive("select", select_);
  archive("locked", locked_);
  if (!legal(multiplier_, divider_)) archive.refuse("has an illegal ratio");
}

}  // namespace capsoc::peripherals
