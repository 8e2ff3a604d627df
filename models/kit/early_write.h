// TLM extension: a write that a device takes ahead of the kernel.
#pragma once

#include <tlm>

namespace capsoc::kit {

/// On a write's payload. An initiator that is ahead of the kernel need not synchronise before the
/// write, if the device takes it early and the kernel has no activity before it. The initiator's
/// lead is the delay of the write. The device acts at that time, and no other component notices
/// before. Devices without support never set `taken`, so no early write reaches them.
struct EarlyWrite : tlm::tlm_extension<EarlyWrite> {
  /// Set by the initiator: the write is ahead of the kernel. Only to an address whose last write
  /// was `taken`.
  bool early = false;
  /// Set by the device: this write is, or would be, taken early in the present state. A write that
  /// is early and not taken has no effect: the initiator repeats it at its time.
  bool taken = false;

  bool refused() const { return early && !taken; }
  tlm::tlm_extension_base* clone() const override { return new EarlyWrite(*this); }
  void copy_from(const tlm::tlm_extension_base& other) override {
    early = static_cast<const EarlyWrite&>(other).early;
    taken = static_cast<const EarlyWrite&>(other).taken;
  }
};

}  // namespace capsoc::kit
