#include "armv7m/system/nvic.h"

#include <algorithm>
#include <cstring>

#include "base/archive.h"

namespace capsoc::armv7m {
namespace {

constexpr unsigned reserved_exceptions[] = {7, 8, 9, 10, 13};
constexpr uint32_t first_of_shpr = 4;  // exception

bool in_register(uint32_t address, ppb::Address first, uint32_t words) {
  return address - first < 4 * words;
}
/// The exception whose priority is at an address of IPR or SHPR.
unsigned exception_at(uint32_t address) {
  return in_register(address, ppb::NVIC_IPR, 8)
             ? exception::first_interrupt + address - ppb::NVIC_IPR
             : first_of_shpr + address - ppb::SHPR;
}
uint32_t interrupts_of(uint64_t mask) {
  return static_cast<uint32_t>(mask >> exception::first_interrupt);
}

}  // namespace

bool has_priorities(uint32_t address) {
  return in_register(address, ppb::NVIC_IPR, 8) || in_register(address, ppb::SHPR, 3);
}

bool is_reserved_priority(uint32_t address) {
  if (!in_register(address, ppb::SHPR, 3)) return false;
  const unsigned* end = std::end(reserved_exceptions);
  return std::find(std::begin(reserved_exceptions), end, exception_at(address)) != end;
}

void Nvic::reset() {
  pending_ = active_ = enabled_ = 0;
  lines_ = 0;
  priority_.fill(0);
}

void Nvic::visit(Archive& archive) {
  archive("pending", pending_);
  archive("active", active_);
  archive("enabled", enabled_);
  archive("lines", lines_);
  archive("priority", priority_);
  constexpr uint64_t exceptions = (uint64_t{1} << exception::count) - 1;
  if (((pending_ | active_ | enabled_) & ~exceptions) != 0)
    archive.refuse("has exceptions above 47");
}

void Nvic::set_pending(unsigned number, bool pending) {
  pending_ = pending ? pending_ | bit(number) : pending_ & ~bit(number);
}

void Nvic::set_active(unsigned number, bool active) {
  active_ = active ? active_ | bit(number) : active_ & ~bit(number);
}

bool Nvic::set_line(unsigned line, bool level) {
  const bool before = ((lines_ >> line) & 1) != 0;
  lines_ = level ? lines_ | 1u << line : lines_ & ~(1u << line);
  return level && !before;
}

bool Nvic::line_is_high(unsigned number) const {
  return number >= exception::first_interrupt &&
         ((lines_ >> (number - exception::first_interrupt)) & 1) != 0;
}

void Nvic::set_priority_bits(unsigned bits) {
  priority_mask_ = 0xFF00u >> bits & 0xFF;
}

uint32_t Nvic::read(uint32_t address) const {
  if (has_priorities(address)) {
    uint32_t value = 0;
    std::memcpy(&value, &priority_[exception_at(address)], 4);
    return value;
  }
  switch (address) {
    case ppb::NVIC_ISER:
    case ppb::NVIC_ICER:
      return interrupts_of(enabled_);
    case ppb::NVIC_ISPR:
    case ppb::NVIC_ICPR:
      return interrupts_of(pending_);
    case ppb::NVIC_IABR:
      return interrupts_of(active_);
    default:
      return 0;
  }
}

void Nvic::write(const SystemRegister& target, uint32_t address, const LaneWrite& write) {
  if (has_priorities(address)) {
    const unsigned first = exception_at(address);
    const uint32_t value = write.value & target.description.writable_mask;
    for (unsigned i = 0; i < 4; ++i)
      if ((write.lanes >> (8 * i) & 0xFF) != 0)
        priority_[first + i] = static_cast<uint8_t>((value >> (8 * i)) & priority_mask_);
    for (const unsigned reserved : reserved_exceptions) priority_[reserved] = 0;
    return;
  }
  const uint64_t ones = static_cast<uint64_t>(write.over(0)) << exception::first_interrupt;
  switch (address) {
    case ppb::NVIC_ISER:
      enabled_ |= ones;
      break;
    case ppb::NVIC_ICER:
      enabled_ &= ~ones;
      break;
    case ppb::NVIC_ISPR:
      pending_ |= ones;
      break;
    case ppb::NVIC_ICPR:
      // A line that is high and not active pends again at once.
      pending_ &= ~ones;
      pending_ |= (static_cast<uint64_t>(lines_) << exception::first_interrupt) & ones & ~active_;
      break;
    default:
      break;
  }
}

}  // namespace capsoc::armv7m
