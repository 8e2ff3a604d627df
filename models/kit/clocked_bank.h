// A register bank whose state moves with PCLK, without a process that ticks.
#pragma once

#include <cstdint>
#include <limits>
#include <systemc>

#include "kit/clock_domain.h"
#include "kit/register_bank.h"

namespace capsoc::kit {

/// Registers whose state is a function of the edge number. advance() brings it to an edge.
/// next_change() returns the edge at which something becomes visible outside: an interrupt, a byte
/// on the line. Exactly one event is kept for that edge. A change of frequency moves the event, not
/// the edge number.
///
/// Registers that are computed are functions of the edge, too (now()), so that reads may be made
/// ahead of the kernel. Every access first advances, so the order of an event and an access in one
/// instant is fixed: the event's effect comes first.
class ClockedBank : public RegisterBank {
 public:
  void restored() override;

 protected:
  static constexpr uint64_t never = std::numeric_limits<uint64_t>::max();

  ClockedBank(const sc_core::sc_module_name& name, ClockDomain& clock);

  /// The edge at which the access in progress happens, or the last one so far.
  uint64_t now() const { return clock_.cycles_at(access_time()); }

  /// The last edge at the time of saved state.
  uint64_t edge_of(const Archive& archive) const {
    return clock_.cycles_at(sc_core::sc_time::from_value(archive.time()));
  }

  /// Does all that is due at or before `cycle`.
  virtual void advance(uint64_t cycle) = 0;
  /// The next edge that must not be missed, or never.
  virtual uint64_t next_change() const = 0;
  /// Moves the event to next_change(). For every entry that is not a register access.
  void plan();

  bool read_word(uint32_t offset, uint32_t& value, bool debug) override;
  bool write_word(uint32_t offset, uint32_t value, uint32_t lanes) override;
  bool is_read_ahead(uint32_t offset) const override { return has_plain_read(offset); }

 private:
  void on_event();
  void on_clock_change();

  ClockDomain& clock_;
  sc_core::sc_event event_;
  uint64_t planned_ = never;
};

}  // namespace capsoc::kit
