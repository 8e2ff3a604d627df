// TLM extension: the way of a transaction to its register, so that later ones need not take it.
#pragma once

#include <cstdint>
#include <systemc>
#include <tlm>

#include "kit/probe.h"

namespace capsoc::kit {

class RegisterTarget;

/// What answers every read of its window with 0, always and at once.
class ZeroTarget {
 public:
  /// For a read that was left out: what the target does in addition to its answer.
  virtual void read_zero() = 0;

 protected:
  ~ZeroTarget() = default;
};

/// Notified of each transfer of an interconnect that was answered (bus::AhbMatrix::transfers).
using TransferProbe =
    Probe<const tlm::tlm_generic_payload&, const sc_core::sc_time&, const sc_core::sc_time&>;

/// On a payload of at most four bytes. The target and each interconnect on the way back describe
/// what the transaction met. The initiator may then leave out later transactions of the same kind
/// and call the target itself (RegisterTarget::read_ahead, write_early, ZeroTarget::read_zero), if
/// - the description reaches its own socket: a component that knows nothing of it, a monitor for
///   example, is between two others, and ends it there;
/// - the real transaction took as many cycles as described;
/// - the interconnect's transfers have no listener, now as then.
/// An interconnect whose way changes calls invalidate_direct_mem_ptr() for the addresses. The
/// initiator owns the extension and removes it before the payload's end of life.
struct DirectRoute : tlm::tlm_extension<DirectRoute> {
  using Interface = tlm::tlm_fw_transport_if<>;

  RegisterTarget* target = nullptr;  ///< null: none described itself
  uint32_t offset = 0;               ///< of the register, a multiple of 4
  ZeroTarget* zeros = nullptr;       ///< in place of `target`: all of `first` to `last` reads 0
  uint64_t first = 0, last = 0;      ///< addresses, as the initiator of `reached` has them
  unsigned cycles = 0;               ///< of the interconnects' clock, beyond the access itself
  const TransferProbe* transfers = nullptr;  ///< of the one interconnect that has such
  const Interface* reached = nullptr;        ///< the socket up to which all of this holds

  /// Before a transaction.
  void clear() {
    target = nullptr;
    zeros = nullptr;
  }
  bool is_described() const { return target != nullptr || zeros != nullptr; }
  /// The target, whose socket it is.
  void begin(RegisterTarget& at, uint32_t register_offset, const Interface* socket) {
    target = &at;
    zeros = nullptr;
    offset = register_offset;
    begin_at(socket);
  }
  /// The same of a target all of whose addresses read 0.
  void begin(ZeroTarget& at, const Interface* socket) {
    target = nullptr;
    zeros = &at;
    first = 0;
    last = ~uint64_t{0};
    begin_at(socket);
  }
  /// An interconnect that passed the transaction on to `to`, got it at `from` and adds cycles.
  void extend(const Interface* to, const Interface* from, unsigned added) {
    if (reached != to) return clear();
    reached = from;
    cycles += added;
  }
  /// An interconnect decodes only `window_first` to `window_last` so; the address `local` of the
  /// target is its `address`. Before extend().
  void decode(uint64_t local, uint64_t address, uint64_t window_first, uint64_t window_last) {
    const bool begins_before = address - window_first > local - first;
    const bool ends_after = window_last - address > last - local;
    first = begins_before ? address - (local - first) : window_first;
    last = ends_after ? address + (last - local) : window_last;
  }
  /// True if all the way from the socket `to` is described.
  bool is_whole(const Interface* to) const { return is_described() && reached == to; }

  tlm::tlm_extension_base* clone() const override { return new DirectRoute(*this); }
  void copy_from(const tlm::tlm_extension_base& other) override {
    *this = static_cast<const DirectRoute&>(other);
  }

 private:
  void begin_at(const Interface* socket) {
    cycles = 0;
    transfers = nullptr;
    reached = socket;
  }
};

}  // namespace capsoc::kit
