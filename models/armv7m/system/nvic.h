#pragma once

#include <array>
#include <cstdint>

#include "armv7m/system/exception_number.h"
#include "armv7m/system/registers.h"

namespace capsoc {
class Archive;
}

namespace capsoc::armv7m {

/// The nested vectored interrupt controller (B3.4), for all exceptions: which are pending, active
/// and enabled, and their priorities. Bit n of a mask is exception n.
class Nvic {
 public:
  /// 0 for a number that no exception has, which a program can write into a stacked IPSR.
  static constexpr uint64_t bit(unsigned number) {
    return number < exception::count ? uint64_t{1} << number : 0;
  }

  /// Priorities and their implemented bits stay until set again.
  void reset();
  void visit(Archive& archive);

  uint64_t pending() const { return pending_; }
  uint64_t active() const { return active_; }
  bool is_pending(unsigned number) const { return (pending_ & bit(number)) != 0; }
  bool is_active(unsigned number) const { return (active_ & bit(number)) != 0; }
  /// Of interrupts.
  bool is_enabled(unsigned number) const { return (enabled_ & bit(number)) != 0; }
  unsigned active_count() const { return static_cast<unsigned>(__builtin_popcountll(active_)); }

  void set_pending(unsigned number, bool pending);
  void set_active(unsigned number, bool active);

  /// The level of an interrupt's input; true: it has risen.
  bool set_line(unsigned line, bool level);
  /// Of the input after an exception's number; low for those that have none.
  bool line_is_high(unsigned number) const;

  /// Implemented bits of each priority (B1.5.4), up to 8 from the most significant one down.
  void set_priority_bits(unsigned bits);
  uint32_t priority_mask() const { return priority_mask_; }
  /// Reset, NMI and HardFault have fixed ones below 0 (B1.5.4).
  int priority(unsigned number) const {
    return number <= exception::hard_fault ? static_cast<int>(number) - 4 : priority_[number];
  }

  uint32_t read(uint32_t address) const;
  /// `address`: of the word, in `target`.
  void write(const SystemRegister& target, uint32_t address, const LaneWrite& write);

 private:
  uint64_t pending_ = 0, active_ = 0, enabled_ = 0;
  uint32_t lines_ = 0;  // levels of the interrupt inputs
  std::array<uint8_t, exception::count> priority_{};
  uint32_t priority_mask_ = 0xE0;  // the bits that are implemented: not state, but how it is built
};

/// The priorities that NVIC_IPR and SHPR hold.
bool has_priorities(uint32_t address);
/// A byte of SHPR that belongs to no exception and stays zero.
bool is_reserved_priority(uint32_t address);

}  // namespace capsoc::armv7m
