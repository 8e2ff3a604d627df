// TLM extension: what a device declares about a read, in addition to its answer.
#pragma once

#include <tlm>

namespace capsoc::kit {

/// On a read's payload: a device says by it that the same read gives the same answer, and does
/// nothing, until something else happens: a write, an event of the kernel, another device's turn.
/// So an initiator that only waits there need not ask again before, and may ask ahead of the
/// kernel, with its lead as the delay. Belongs to the initiator, who takes it off the payload
/// before the payload ends. Devices that do not know it are right, too.
struct SteadyRead : tlm::tlm_extension<SteadyRead> {
  bool steady = false;
  /// It does nothing, and its answer is that of its own time, also where the kernel is not there
  /// yet and has nothing to do before: it may be made ahead, but not left out.
  bool ahead = false;

  tlm::tlm_extension_base* clone() const override { return new SteadyRead(*this); }
  void copy_from(const tlm::tlm_extension_base& other) override {
    steady = static_cast<const SteadyRead&>(other).steady;
    ahead = static_cast<const SteadyRead&>(other).ahead;
  }
};

}  // namespace capsoc::kit
