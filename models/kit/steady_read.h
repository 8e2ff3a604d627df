// TLM extension: what a device declares about a read, in addition to its answer.
#pragma once

#include <tlm>

namespace capsoc::kit {

/// On a read's payload. The device declares that the same read has no side effect and gives the
/// same answer until a write, an event of the kernel or another device's activity. An initiator
/// that only polls need not repeat the read before that. It may also read ahead of the kernel, with
/// its lead as the delay. The initiator owns the extension and removes it before the payload's end
/// of life. Targets may ignore it.
struct SteadyRead : tlm::tlm_extension<SteadyRead> {
  bool steady = false;
  /// The read has no side effect and answers for its time (now plus delay), even if the kernel is
  /// not there yet and has no activity before. It may be made ahead of the kernel, but not omitted.
  bool ahead = false;

  tlm::tlm_extension_base* clone() const override { return new SteadyRead(*this); }
  void copy_from(const tlm::tlm_extension_base& other) override {
    steady = static_cast<const SteadyRead&>(other).steady;
    ahead = static_cast<const SteadyRead&>(other).ahead;
  }
};

}  // namespace capsoc::kit
