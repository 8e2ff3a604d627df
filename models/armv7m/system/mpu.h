#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "armv7m/isa/unpredictable.h"
#include "armv7m/system/registers.h"

namespace capsoc {
class Archive;
}

namespace capsoc::armv7m {

/// Rights that an access needs, a number below 8.
struct Right {
  static constexpr unsigned privileged = 1, fetch = 2, write = 4;
  static constexpr unsigned kinds = 8;
};

/// The memory protection unit (B3.5): eight regions.
class Mpu {
 public:
  static constexpr unsigned regions = 8;

  void reset() { *this = {}; }
  void visit(Archive& archive);

  /// Whether accesses are compared with the regions at all. `at_negative_priority`: in HardFault
  /// and NMI, and with FAULTMASK (HFNMIENA, B3.5.5).
  bool applies(bool at_negative_priority) const {
    if ((ctrl_ & ctrl_enable) == 0) return false;
    return (ctrl_ & ctrl_hfnmiena) != 0 || !at_negative_priority;
  }
  /// ValidateAddress (B3.5.3): bit n is set if an access of kind n (Right) is allowed. The result
  /// is the same within 32 bytes.
  uint32_t rights(uint32_t address) const;
  /// True for Normal or Device memory by the region's TEX, C and B, false for Strongly-ordered;
  /// empty where the default map decides.
  std::optional<bool> buffers(uint32_t address) const;
  /// True when no border of a region or of its eighths runs through the page of the address.
  bool uniform_in_page(uint32_t address, unsigned page_bits) const;

  uint32_t read(uint32_t address) const;
  void write(uint32_t address, uint32_t value);
  unsigned selected() const { return rnr_; }
  /// The UNPREDICTABLE settings of a region that is enabled, as tell(which) each.
  template <typename Tell>
  void check_region(unsigned number, const Tell& tell) const;

 private:
  static constexpr uint32_t ctrl_enable = 1, ctrl_hfnmiena = 2, ctrl_privdefena = 4;
  /// The highest region that matches an address, -1 for none.
  int region(uint32_t address) const;

  uint32_t ctrl_ = 0, rnr_ = 0;
  std::array<uint32_t, regions> rbar_{}, rasr_{};
};

template <typename Tell>
void Mpu::check_region(unsigned number, const Tell& tell) const {
  const uint32_t rasr = rasr_[number], bits = ((rasr >> 1) & 31) + 1;
  if ((rasr & 1) == 0) return;
  const bool misplaced = bits < 32 && (rbar_[number] & ((1u << bits) - 1)) != 0;
  if (bits < 5)
    tell(Unpredictable::mpu_size);
  else if (misplaced)
    tell(Unpredictable::mpu_base);
  if (bits < 8 && (rasr >> 8 & 0xFF) != 0) tell(Unpredictable::mpu_subregions);
  if ((rasr >> 24 & 7) == 4) tell(Unpredictable::mpu_permissions);
}

}  // namespace capsoc::armv7m
