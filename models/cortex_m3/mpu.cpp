#include "cortex_m3/core.h"

namespace capsoc::cortex_m3 {
namespace {

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

constexpr unsigned right_of_privileged = 1, right_to_fetch = 2, right_to_write = 4;

/// The kind of an access as a number below 8.
constexpr unsigned right(bool write, bool fetch, bool priv) {
  return (write ? right_to_write : 0) | (fetch ? right_to_fetch : 0) |
         (priv ? right_of_privileged : 0);
}

}  // namespace

/// Whether accesses are held against the regions at all: HFNMIENA (B3.5.5).
bool Core::mpu_applies() const {
  if ((state_.mpu.ctrl & 1) == 0) return false;
  return (state_.mpu.ctrl & 2) != 0 ||
         (state_.faultmask == 0 && state_.ipsr != 2 && state_.ipsr != 3);
}

/// The highest region that matches an address, -1 for none (B3.5.3).
int Core::mpu_region(uint32_t address) const {
  for (unsigned n = 8; n-- > 0;) {
    uint32_t rasr = state_.mpu.rasr[n];
    unsigned bits = ((rasr >> 1) & 31) + 1;
    if ((rasr & 1) == 0 || bits < 5) continue;
    uint64_t size = uint64_t{1} << bits;
    uint32_t base = state_.mpu.rbar[n] & ~static_cast<uint32_t>(size - 1);
    uint32_t offset = address - base;
    if (offset >= size) continue;
    if (bits >= 8 && ((rasr >> (8 + (offset >> (bits - 3)))) & 1)) continue;
    return static_cast<int>(n);
  }
  return -1;
}

/// ValidateAddress (B3.5.3): the region decides, or the default map. Nothing differs within 32
/// bytes, so what was decided is kept for as many lines as a task's stack and data have; in a
/// program whose regions share pages, as the stacks of an RTOS do, that is every access.
bool Core::mpu_allows(uint32_t address, bool write, bool fetch, bool priv) {
  if (!mpu_applies()) return true;
  MpuLine& line = mpu_lines_[address >> 5 & (mpu_lines_.size() - 1)];
  const uint32_t tag = address >> 5 | 1u << 31;
  if (line.tag != tag) line = {tag, mpu_rights(address)};
  return (line.rights >> right(write, fetch, priv) & 1) != 0;
}

/// A bit for each kind of access, in the order of right().
uint32_t Core::mpu_rights(uint32_t address) const {
  const int region = mpu_region(address);
  const bool background = (state_.mpu.ctrl & 4) != 0;
  const uint32_t rasr = region < 0 ? 0 : state_.mpu.rasr[static_cast<unsigned>(region)];
  const bool never_execute = (rasr & 1u << 28) != 0;
  uint32_t rights = 0;
  for (unsigned kind = 0; kind < 8; ++kind) {
    const bool write = (kind & right_to_write) != 0, fetch = (kind & right_to_fetch) != 0,
               priv = (kind & right_of_privileged) != 0;
    const bool allowed =
        region < 0 ? priv && background
                   : !(fetch && never_execute) && permitted((rasr >> 24) & 7, write, priv);
    rights |= uint32_t{allowed} << kind;
  }
  return rights;
}

void Core::mpu_changed() {
  mpu_lines_.fill({});
  memory_.clear_views();
}

/// True when no border of a region or of its eighths runs through the page of the address.
bool Core::mpu_uniform_in_page(uint32_t address) const {
  for (unsigned n = 0; n < 8; ++n) {
    uint32_t rasr = state_.mpu.rasr[n];
    unsigned bits = ((rasr >> 1) & 31) + 1;
    if ((rasr & 1) == 0 || bits < 5) continue;
    const bool eighths = bits >= 8 && ((rasr >> 8) & 0xFF) != 0;
    if ((eighths ? bits - 3 : bits) >= Memory::page_bits) continue;
    uint32_t span = bits >= Memory::page_bits ? ~0u << (bits - 1) << 1 : ~(Memory::page_size - 1);
    if (((address ^ state_.mpu.rbar[n]) & span) == 0) return false;
  }
  return true;
}

/// The table of direct pages for the present privilege and MPU.
void Core::select_view() {
  if (mpu_applies()) {
    fast_pages_ = memory_.view(privileged() ? Memory::View::privileged : Memory::View::user);
  } else if (watches_data() || sees_accesses_) {
    fast_pages_ = memory_.view(Memory::View::unprotected);
  } else {
    fast_pages_ = memory_.table();
  }
}

/// Behind an access that the regions let through: the next ones to its page need no look at them.
void Core::fill_view(uint32_t address) {
  const Memory::Page& page = memory_.page(address);
  if (fast_pages_ == memory_.table() || page.read == nullptr) return;
  if (fast_pages_[address >> Memory::page_bits].mixed) return;
  if (sees_accesses_ || watches_page(address)) return;
  const bool priv = privileged();
  Memory::Page& seen = memory_.view_page(fast_pages_, address);
  seen.mixed = !mpu_uniform_in_page(address);
  if (seen.mixed) return;
  seen.wait_states = page.wait_states;
  if (mpu_allows(address, false, false, priv)) seen.read = page.read;
  if (mpu_allows(address, true, false, priv)) seen.write = page.write;
}

void Core::write_mpu(uint32_t address, uint32_t value) {
  uint32_t offset = (address & 0xFF) - 0x90;
  switch (offset) {
    case 0x04:
      state_.mpu.ctrl = value & 7;
      break;
    case 0x08:
      state_.mpu.rnr = value & 7;
      break;
    case 0x0C:
    case 0x14:
    case 0x1C:
    case 0x24:
      if (value & 0x10) state_.mpu.rnr = value & 7;
      state_.mpu.rbar[state_.mpu.rnr] = value & ~0x1Fu;
      break;
    case 0x10:
    case 0x18:
    case 0x20:
    case 0x28:
      state_.mpu.rasr[state_.mpu.rnr] = value & 0x173FFF3F;
      break;
    default:
      break;
  }
  mpu_changed();
  check_ = true;
}

}  // namespace capsoc::cortex_m3
