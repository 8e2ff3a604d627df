// The state of the processor: what its future depends on between two instructions, and nothing
// else. Standard layout, so that generated code can address it; what executes most comes first.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "cortex_m3/fault_report.h"
#include "cortex_m3/timing.h"

namespace capsoc::kit {
class Archive;
}

namespace capsoc::cortex_m3 {

/// Exceptions by number (B1.5.2): bit n of a mask is exception n; 16 and up are interrupts.
struct NvicState {
  uint64_t pending = 0, active = 0, enabled = 0;
  uint32_t lines = 0;  ///< levels of the interrupt inputs
  std::array<uint8_t, 48> priority{};

  void visit(kit::Archive& archive);
};

/// System control block (B3.2), with DEMCR.
struct ScbState {
  uint32_t vtor = 0, prigroup = 0, scr = 0, ccr = 0, shcsr = 0, cfsr = 0, hfsr = 0, mmfar = 0,
           bfar = 0, dfsr = 0, actlr = 0, demcr = 0;

  void visit(kit::Archive& archive);
};

/// B3.3. The counter is a function of the cycle since it was started.
struct SystickState {
  static constexpr uint64_t never = ~uint64_t{0};
  uint32_t csr = 0, rvr = 0, start = 0;
  bool countflag = false;
  uint64_t start_cycle = 0;
  uint64_t event = never;   ///< cycle of the next wrap that pends the exception
  unsigned reference = 25;  ///< HCLK cycles of the reference clock

  void visit(kit::Archive& archive);
};

/// Data watchpoint and trace unit (C1.8).
struct DwtState {
  uint32_t ctrl = 0;
  uint64_t cyccnt_base = 0;
  uint32_t cyccnt_stopped = 0;
  std::array<uint32_t, 4> comparator{}, mask{}, function{};
  bool watches_data = false;   ///< accesses: their pages leave the direct tables
  bool observes_step = false;  ///< instructions or cycles: they are executed one by one
  uint32_t count_seen = 0;     ///< CYCCNT up to which cycle matches were looked for

  void visit(kit::Archive& archive);
};

/// Instrumentation trace macrocell (C1.7).
struct ItmState {
  uint32_t ter = 0, tpr = 0, tcr = 0;
  bool unlocked = false;

  void visit(kit::Archive& archive);
};

/// Memory protection unit (B3.5).
struct MpuState {
  uint32_t ctrl = 0, rnr = 0;
  std::array<uint32_t, 8> rbar{}, rasr{};

  void visit(kit::Archive& archive);
};

struct State {
  static constexpr uint64_t never = ~uint64_t{0};

  std::array<uint32_t, 16> r{};  ///< 13: the stack pointer in use; 15 is not used
  uint32_t n = 0, z = 1;         ///< N is bit 31 of n; Z is z == 0
  bool c = false, v = false, q = false;
  uint32_t pc = 0;
  uint64_t cycles = 0, instructions = 0;
  uint8_t it_state = 0;
  bool stalled = false;  ///< a device was accessed: the next instruction overlaps with nothing
  uint16_t trail = timing::no_trail;  ///< of the instruction executed last
  /// instructions at the last exception entry, while it can be displaced
  uint64_t entered_at = never;
  bool thumb = true, sleeping = false, sleeping_for_event = false, locked_up = false;
  bool reset_request = false, semihosting_exit = false, event_register = false;
  uint32_t ipsr = 0, control = 0, primask = 0, faultmask = 0, basepri = 0;
  uint32_t other_sp = 0;   ///< the stack pointer that is not in use
  bool exclusive = false;  ///< the local monitor (A3.4)
  uint32_t exclusive_address = 0;

  NvicState nvic;
  ScbState scb;
  SystickState systick;
  DwtState dwt;
  ItmState itm;
  MpuState mpu;

  FaultReport last_fault, first_fault;
  uint64_t fault_count = 0;
  // What was reported once.
  uint64_t unpredictable_seen = 0;      ///< bit n: case n of unpredictable.def
  std::array<bool, 2> priority_told{};  ///< of bits that were dropped, of nothing but ones

  /// Refuses what no processor can be in.
  void visit(kit::Archive& archive);
};
static_assert(std::is_standard_layout_v<State> && std::is_trivially_copyable_v<State>);

}  // namespace capsoc::cortex_m3
