// What an initiator and a device agree on about a write ahead of the kernel.
#pragma once

#include <tlm>

namespace capsoc::kit {

/// On a write's payload. An initiator that is ahead of the kernel, and knows that the kernel has
/// nothing to do before, need not wait for it where a device takes the write early. The lead is the
/// delay of the write. The device acts at that time, and until then no other component notices.
/// Devices that do not know of this never say so, and are never tried.
struct EarlyWrite : tlm::tlm_extension<EarlyWrite> {
  /// The initiator's: made ahead of the kernel. Only to an address whose last write was `taken`.
  bool early = false;
  /// The device's: such a write, now, is or would be taken early. One that is early and not taken
  /// has done nothing: the initiator makes it again at its time.
  bool taken = false;

  bool refused() const { return early && !taken; }
  tlm::tlm_extension_base* clone() const override { return new EarlyWrite(*this); }
  void copy_from(const tlm::tlm_extension_base& other) override {
    early = static_cast<const EarlyWrite&>(other).early;
    taken = static_cast<const EarlyWrite&>(other).taken;
  }
};

}  // namespace capsoc::kit
