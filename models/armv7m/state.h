// The architectural and timing state of the processor between two instructions, and nothing else.
// Standard layout, so that generated code can address it; the most used members come first.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "armv7m/fault_report.h"
#include "armv7m/isa/timing.h"
#include "armv7m/system/dwt.h"
#include "armv7m/system/fpu.h"
#include "armv7m/system/itm.h"
#include "armv7m/system/mpu.h"
#include "armv7m/system/nvic.h"
#include "armv7m/system/scb.h"
#include "armv7m/system/systick.h"

namespace capsoc {
class Archive;
}

namespace capsoc::armv7m {

struct State {
  static constexpr uint64_t never = Systick::never;

  std::array<uint32_t, 16> r{};  ///< 13: the stack pointer in use; 15 is not used
  uint32_t n = 0, z = 1;         ///< N is bit 31 of n; Z is z == 0
  bool c = false, v = false, q = false;
  uint8_t ge = 0;  ///< bit n: of byte n, by the DSP extension
  uint32_t pc = 0;
  uint64_t cycles = 0, instructions = 0;
  uint8_t it_state = 0;
  bool stalled = false;    ///< a device was accessed: the next instruction does not overlap
  bool refilling = false;  ///< a branch was taken: the target's width and place count, too
  uint16_t trail = timing::no_trail;  ///< of the instruction executed last
  /// instructions at the last exception entry, while it can be displaced
  uint64_t entered_at = never;
  bool thumb = true, sleeping = false, sleeping_for_event = false, locked_up = false;
  bool reset_request = false, semihosting_exit = false, semihosting_waits = false,
       event_register = false;
  uint32_t ipsr = 0, control = 0, primask = 0, faultmask = 0, basepri = 0;
  uint32_t other_sp = 0;   ///< the stack pointer that is not in use
  bool exclusive = false;  ///< the local monitor (A3.4)
  uint32_t exclusive_address = 0;

  Nvic nvic;
  Scb scb;
  Systick systick;
  Dwt dwt;
  Itm itm;
  Mpu mpu;

  FaultReport last_fault, first_fault;
  uint64_t fault_count = 0;
  LostWrite lost_write;  ///< the store of the latest imprecise fault
  // Reports that are made only once.
  uint64_t unpredictable_seen = 0;      ///< bit n: case n of unpredictable.def
  std::array<bool, 2> priority_told{};  ///< of bits that were dropped, of nothing but ones
  /// Of a core with the extension; others neither change nor save it.
  Fpu fpu;

  /// Saves or loads; refuses a state that no processor can have.
  void visit(Archive& archive);
  /// Power-on reset of everything but the time; does not read the vector table.
  void reset(const SystemRegisters& registers);

  /// r0-r12, 13 the stack pointer in use, 14 LR, 15 the address of the next instruction.
  uint32_t reg(unsigned number) const { return number == 15 ? pc : r[number & 15]; }
  /// Writing 15 lets a processor that sleeps or is locked up continue there.
  void set_reg(unsigned number, uint32_t value);
  uint32_t xpsr() const;
  /// `value` without bits that the core does not have (Profile::xpsr_bits).
  void set_xpsr(uint32_t value);
  /// N, Z, C, V, Q and GE from their places in APSR.
  void set_apsr(uint32_t value);
  bool condition_passed(unsigned condition) const;

  bool in_fault_handler() const { return exception::is_fault(ipsr); }
  bool privileged() const { return ipsr != 0 || (control & 1) == 0; }
  /// True at priorities where HFNMIENA may disable the MPU (B3.5.5).
  bool at_negative_priority() const {
    return faultmask != 0 || ipsr == exception::nmi || ipsr == exception::hard_fault;
  }
  /// CONTROL.FPCA: the floating-point registers belong to the code that is executing.
  static constexpr uint32_t control_fpca = 4;
  bool has_fp_context() const { return (control & control_fpca) != 0; }
  bool uses_psp() const { return ipsr == 0 && (control & 2) != 0; }
  uint32_t msp() const { return uses_psp() ? other_sp : r[13]; }
  uint32_t psp() const { return uses_psp() ? r[13] : other_sp; }
  void set_msp(uint32_t value) { (uses_psp() ? other_sp : r[13]) = value & ~3u; }
  void set_psp(uint32_t value) { (uses_psp() ? r[13] : other_sp) = value & ~3u; }
  /// The stack pointer in use is in r[13], the other one in other_sp. Switching exchanges them.
  void select_stack(bool process);
  /// SPSEL can be written in Thread mode only (B1.4.4). `value` has FPCA only on a core that has it
  /// (Profile::control_bits).
  void set_control(uint32_t value);
  void set_primask(bool masked) { primask = masked ? 1 : 0; }
  void set_faultmask(bool masked) { faultmask = masked ? 1 : 0; }
  void set_basepri(uint32_t value) { basepri = value & nvic.priority_mask(); }
};
static_assert(std::is_standard_layout_v<State> && std::is_trivially_copyable_v<State>);

inline bool State::condition_passed(unsigned condition) const {
  const bool negative = (n >> 31) != 0, zero = z == 0;
  bool result = false;
  switch (condition >> 1) {
    case 0:
      result = zero;
      break;
    case 1:
      result = c;
      break;
    case 2:
      result = negative;
      break;
    case 3:
      result = v;
      break;
    case 4:
      result = c && !zero;
      break;
    case 5:
      result = negative == v;
      break;
    case 6:
      result = negative == v && !zero;
      break;
    default:
      return true;
  }
  return result != ((condition & 1) != 0);
}

}  // namespace capsoc::armv7m
