#pragma once

#include <cstdint>

#include "armv7m/event.h"
#include "armv7m/system/nvic.h"
#include "armv7m/system/registers.h"

namespace capsoc {
class Archive;
}

namespace capsoc::armv7m {

/// The system control block (B3.2), with the debug monitor's DEMCR (C1.6.5): configuration and
/// fault status. The only place that names the bits of these registers.
class Scb {
 public:
  void reset(const SystemRegisters& registers);
  void visit(Archive& archive);

  uint32_t vector(unsigned number) const { return vtor_ + 4 * number; }
  void set_vector_table(uint32_t address) { vtor_ = address; }
  /// The part of a priority that decides on preemption (AIRCR.PRIGROUP); fixed priorities have no
  /// subpriority.
  int group_priority(int priority) const {
    return priority < 0 ? priority : priority & ~((2 << prigroup_) - 1) & 0xFF;
  }

  // CCR
  bool traps_division_by_zero() const { return (ccr_ & 1u << 4) != 0; }
  bool traps_unaligned() const { return (ccr_ & unalign_trp) != 0; }
  /// The register that has it, for the host's code that a translator writes.
  const uint32_t& word_with_unalign_trp() const { return ccr_; }
  static constexpr uint32_t unalign_trp = 1u << 3;
  bool aligns_stack() const { return (ccr_ & 1u << 9) != 0; }
  bool ignores_bus_faults() const { return (ccr_ & 1u << 8) != 0; }  ///< BFHFNMIGN
  bool allows_nonbase_thread() const { return (ccr_ & 1u << 0) != 0; }
  bool user_may_pend() const { return (ccr_ & 1u << 1) != 0; }
  // SCR, ACTLR
  bool sends_event_on_pend() const { return (scr_ & 1u << 4) != 0; }
  bool sleeps_on_exit() const { return (scr_ & 1u << 1) != 0; }
  bool folds_it() const { return (actlr_ & 1u << 2) == 0; }             ///< DISFOLD is clear
  bool write_buffer_is_off() const { return (actlr_ & 1u << 1) != 0; }  ///< DISDEFWBUF

  /// MemManage, BusFault and UsageFault (SHCSR).
  bool fault_enabled(unsigned number) const { return (shcsr_ & 1u << (number + 12)) != 0; }

  // DEMCR
  bool tracing() const { return (demcr_ & 1u << 24) != 0; }  ///< TRCENA
  bool monitor_enabled() const { return (demcr_ & 1u << 16) != 0; }
  bool monitor_steps() const { return monitor_enabled() && (demcr_ & 1u << 18) != 0; }
  void set_demcr(uint32_t value);
  uint32_t demcr() const { return demcr_; }  ///< without MON_PEND

  /// The status bits of a fault; returns the exception that it raises. `address`: for MMFAR, BFAR.
  unsigned record(Cause cause, uint32_t address);
  /// The bus error of a buffered store whose instruction had retired (B1.5.14).
  void record_imprecise() { cfsr_ |= 1u << 10; }
  void record_forced() { hfsr_ |= 1u << 30; }
  void record_vector_table() { hfsr_ |= 1u << 1; }
  void record_debug_event() { hfsr_ |= 1u << 31; }
  /// No fault has happened.
  void forget_faults() { cfsr_ = hfsr_ = mmfar_ = bfar_ = dfsr_ = 0; }
  /// Cause of the DebugMonitor exception (C1.6.1).
  enum class DebugReason : uint32_t { halted = 1 << 0, bkpt = 1 << 1, dwttrap = 1 << 2 };
  void record(DebugReason reason) { dfsr_ |= static_cast<uint32_t>(reason); }

  uint32_t cfsr() const { return cfsr_; }
  uint32_t hfsr() const { return hfsr_; }
  uint32_t mmfar() const { return mmfar_; }
  uint32_t bfar() const { return bfar_; }
  /// The address in BFAR or MMFAR, whichever is valid, else `otherwise`.
  uint32_t fault_address(uint32_t otherwise) const;

  uint32_t read(uint32_t address, const Nvic& nvic) const;
  /// True: the program asks for a reset (AIRCR.SYSRESETREQ).
  bool write(const SystemRegister& target, const LaneWrite& write, Nvic& nvic);

 private:
  uint32_t vtor_ = 0, prigroup_ = 0, scr_ = 0, ccr_ = 0, shcsr_ = 0, cfsr_ = 0, hfsr_ = 0,
           mmfar_ = 0, bfar_ = 0, dfsr_ = 0, actlr_ = 0, demcr_ = 0;
};

}  // namespace capsoc::armv7m
