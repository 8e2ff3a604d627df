#pragma once

#include <cstdint>
#include <set>
#include <vector>

namespace capsoc::cortex_m3 {

class Machine;

/// Data accesses that a debugger wants to see: loads and stores of instructions to a range.
struct Watchpoint {
  uint32_t address = 0, size = 0;
  bool on_read = false, on_write = false;

  bool operator==(const Watchpoint& other) const {
    return address == other.address && size == other.size && on_read == other.on_read &&
           on_write == other.on_write;
  }
};
/// The access that ended a run.
struct WatchHit {
  Watchpoint watchpoint;
  uint32_t address = 0;  ///< first watched byte that was touched
};

/// What a debugger lets the processor stop at. Nothing here is reached while no breakpoint and no
/// watchpoint is set, neither by a debugger nor by the program in the DWT.
class Debugging {
 public:
  explicit Debugging(Machine& machine) : machine_(machine) {}

  /// Ends run() before the instruction at the address; the next run() executes it.
  void set_breakpoint(uint32_t address);
  void clear_breakpoint(uint32_t address) { breakpoints_.erase(address & ~1u); }
  bool has_breakpoint(uint32_t address) const { return breakpoints_.count(address & ~1u) != 0; }
  bool has_breakpoints() const { return !breakpoints_.empty(); }
  /// The next run() executes the instruction at PC whether it has a breakpoint or not.
  void pass_breakpoint();
  /// True once for every arrival at a breakpoint.
  bool at_breakpoint();
  /// As with halting debug (C1.6): BKPT ends run() with breakpoint before it is executed, instead
  /// of raising a fault.
  void set_halting(bool enabled) { halting_ = enabled; }
  bool halting() const { return halting_; }
  /// Whether the debugger holds the processor; only DHCSR shows it.
  void set_halted(bool halted) { halted_ = halted; }
  /// DHCSR (C1.6.2): C_DEBUGEN while a debugger is attached, C_HALT, S_HALT and S_REGRDY while it
  /// holds the processor.
  uint32_t control_and_status() const;

  /// As the printf viewer of a debugger does (C1.7): DEMCR.TRCENA, ITM_TCR.ITMENA and the bits of
  /// ITM_TER that `ports` names (bit n is port n) are set, now and after each reset. Off: these
  /// bits of ITM_TER are cleared, and trace stays on.
  void show_stimulus(uint32_t ports, bool on);
  uint32_t stimulus_ports() const { return stimulus_ports_; }
  /// After a reset, or a restored state that another debugger left.
  void set_up_trace();

  /// Ends run() behind the instruction that made such an access.
  void set_watchpoint(const Watchpoint& watchpoint);
  void clear_watchpoint(const Watchpoint& watchpoint);
  const WatchHit& watch_hit() const { return watch_hit_; }
  /// The debugger or the program watches data anywhere, or in the page of an address.
  bool watches_data() const;
  bool watches_page(uint32_t address) const;
  /// Notes an access to a watched byte; the present instruction is the last one of the run then.
  bool watched(uint32_t address, unsigned size, bool write);

  /// Behind a reset or a restore: no arrival is remembered.
  void forget_arrival();

 private:
  Machine& machine_;
  std::set<uint32_t> breakpoints_;
  uint64_t passed_at_ = ~uint64_t{0};  // instructions when the one at passed_pc_ was passed
  uint32_t passed_pc_ = 0;
  std::vector<Watchpoint> watchpoints_;
  WatchHit watch_hit_;
  bool halting_ = false, halted_ = false;
  bool traces_ = false;
  uint32_t stimulus_ports_ = 0;
};

}  // namespace capsoc::cortex_m3
