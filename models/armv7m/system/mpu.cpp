#include "armv7m/system/mpu.h"

#include "base/archive.h"

namespace capsoc::armv7m {
namespace {

constexpr uint32_t rasr_enable = 1, rasr_xn = 1u << 28, rasr_tex_c_b = 0x003B0000;
constexpr uint32_t rasr_writable = 0x173FFF3F;
constexpr uint32_t rbar_valid = 0x10, rbar_region = 7, rbar_address = ~0x1Fu;

/// Access permissions AP of a region (B3.5.6).
bool permitted(unsigned ap, bool write, bool priv) {
  switch (ap) {
    case 1:
      return priv;
    case 2:
      return priv || !write;
    case 3:
      return true;
    case 5:
      return priv && !write;
    case 6:
    case 7:
      return !write;
    default:
      return false;
  }
}

/// Bytes of a region as a power of two; below 5 there is none.
unsigned size_bits(uint32_t rasr) {
  return (rasr >> 1 & 31) + 1;
}
bool is_region(uint32_t rasr) {
  return (rasr & rasr_enable) != 0 && size_bits(rasr) >= 5;
}
/// RBAR and RASR alternate, with three aliases.
bool is_rasr(uint32_t address) {
  return ((address - ppb::MPU_RBAR) & 4) != 0;
}

}  // namespace

void Mpu::visit(Archive& archive) {
  archive("ctrl", ctrl_);
  archive.at_most("rnr", rnr_, 7u);
  archive("rbar", rbar_);
  archive("rasr", rasr_);
}

int Mpu::region(uint32_t address) const {
  for (unsigned n = regions; n-- > 0;) {
    if (!is_region(rasr_[n])) continue;
    const unsigned bits = size_bits(rasr_[n]);
    const uint64_t size = uint64_t{1} << bits;
    const uint32_t base = rbar_[n] & ~static_cast<uint32_t>(size - 1);
    const uint32_t offset = address - base;
    if (offset >= size) continue;
    if (bits >= 8 && ((rasr_[n] >> (8 + (offset >> (bits - 3)))) & 1) != 0) continue;
    return static_cast<int>(n);
  }
  return -1;
}

uint32_t Mpu::rights(uint32_t address) const {
  const int matching = region(address);
  const bool background = (ctrl_ & ctrl_privdefena) != 0;
  const uint32_t rasr = matching < 0 ? 0 : rasr_[static_cast<unsigned>(matching)];
  const bool never_execute = (rasr & rasr_xn) != 0;
  uint32_t rights = 0;
  for (unsigned kind = 0; kind < Right::kinds; ++kind) {
    const bool write = (kind & Right::write) != 0, fetch = (kind & Right::fetch) != 0,
               priv = (kind & Right::privileged) != 0;
    const bool allowed =
        matching < 0 ? priv && background
                     : !(fetch && never_execute) && permitted((rasr >> 24) & 7, write, priv);
    rights |= uint32_t{allowed} << kind;
  }
  return rights;
}

std::optional<bool> Mpu::buffers(uint32_t address) const {
  const int matching = region(address);
  if (matching < 0) return std::nullopt;
  return (rasr_[static_cast<unsigned>(matching)] & rasr_tex_c_b) != 0;
}

bool Mpu::uniform_in_page(uint32_t address, unsigned page_bits) const {
  const uint32_t page_size = 1u << page_bits;
  for (unsigned n = 0; n < regions; ++n) {
    if (!is_region(rasr_[n])) continue;
    const unsigned bits = size_bits(rasr_[n]);
    const bool eighths = bits >= 8 && (rasr_[n] >> 8 & 0xFF) != 0;
    if ((eighths ? bits - 3 : bits) >= page_bits) continue;
    const uint32_t span = bits >= page_bits ? ~0u << (bits - 1) << 1 : ~(page_size - 1);
    if (((address ^ rbar_[n]) & span) == 0) return false;
  }
  return true;
}

uint32_t Mpu::read(uint32_t address) const {
  switch (address) {
    case ppb::MPU_CTRL:
      return ctrl_;
    case ppb::MPU_RNR:
      return rnr_;
    default:
      return is_rasr(address) ? rasr_[rnr_] : rbar_[rnr_] | rnr_;
  }
}

void Mpu::write(uint32_t address, uint32_t value) {
  switch (address) {
    case ppb::MPU_CTRL:
      ctrl_ = value & (ctrl_enable | ctrl_hfnmiena | ctrl_privdefena);
      break;
    case ppb::MPU_RNR:
      rnr_ = value & rbar_region;
      break;
    default:
      if (is_rasr(address)) {
        rasr_[rnr_] = value & rasr_writable;
      } else {
        if ((value & rbar_valid) != 0) rnr_ = value & rbar_region;
        rbar_[rnr_] = value & rbar_address;
      }
      break;
  }
}

}  // namespace capsoc::armv7m
