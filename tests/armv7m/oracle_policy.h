#pragma once

#include <unicorn/unicorn.h>

#include <ostream>
#include <string>

#include "armv7m/core.h"
#include "armv7m/isa/decoder.h"
#include "armv7m/isa/unpredictable.h"

/// What of the instruction set Unicorn can judge, and what it gets wrong.
namespace capsoc::armv7m::test {

/// A core that both sides have.
struct OracleCore {
  const char* name;
  const Profile* profile;
  int model;  ///< Unicorn's
};
inline std::ostream& operator<<(std::ostream& out, const OracleCore& core) {
  return out << core.name;
}
inline constexpr OracleCore oracle_cores[] = {
    {"CortexM3", &cortex_m3, UC_CPU_ARM_CORTEX_M3},
    {"CortexM0plus", &cortex_m0plus, UC_CPU_ARM_CORTEX_M0},
    {"CortexM4", &cortex_m4, UC_CPU_ARM_CORTEX_M4},
    {"CortexM4WithFpu", &cortex_m4f, UC_CPU_ARM_CORTEX_M4}};

/// N, Z, C, V and Q, and GE where there is one. Unicorn's Cortex-M0 keeps a Q, too.
inline uint32_t apsr_bits(const Profile& profile) {
  constexpr uint32_t ge = 0x000F0000;
  return 0xF8000000 | (profile.has_dsp() ? ge : 0);
}

/// The xPSR of the oracle, which takes GE under another name.
inline void write_flags(uc_engine* uc, uint32_t xpsr) {
  uc_reg_write(uc, UC_ARM_REG_XPSR, &xpsr);
  uc_reg_write(uc, UC_ARM_REG_APSR_NZCVQG, &xpsr);
}

/// Lets programs use the FPU, where there is one.
inline void enable_fpu(uc_engine* uc) {
  const uint32_t cp10_and_cp11 = 0x00F00000, enable = 1u << 30;
  uc_reg_write(uc, UC_ARM_REG_C1_C0_2, &cp10_and_cp11);
  uc_reg_write(uc, UC_ARM_REG_FPEXC, &enable);
  const uint32_t fpca = 4;  // else the first instruction takes FPSCR from FPDSCR
  uc_reg_write(uc, UC_ARM_REG_CONTROL, &fpca);
}
inline void enable_fpu(Core& core) {
  const uint32_t cp10_and_cp11 = 0x00F00000;
  core.debug_write(ppb::CPACR, &cp10_and_cp11, 4);
}
/// The same numbers in the registers of both, and FPSCR.
template <typename Random>
void fill_fpu(Core& core, uc_engine* uc, Random& random) {
  if (!core.profile().has_fpu()) return;
  enable_fpu(core);
  State& state = core.edit();
  state.set_control(State::control_fpca);
  for (unsigned n = 0; n < Fpu::registers; ++n) {
    const auto value = static_cast<uint32_t>(random());
    state.fpu.set_s(n, value);
    uc_reg_write(uc, UC_ARM_REG_S0 + static_cast<int>(n), &value);
  }
  const Fpscr fpscr(static_cast<uint32_t>(random()));
  state.fpu.status() = fpscr;
  const uint32_t bits = fpscr.bits();
  uc_reg_write(uc, UC_ARM_REG_FPSCR, &bits);
}
/// The name of the first register that differs, or "".
inline std::string fpu_difference(const Core& core, uc_engine* uc) {
  if (!core.profile().has_fpu()) return "";
  uint32_t theirs = 0;
  for (unsigned n = 0; n < Fpu::registers; ++n) {
    uc_reg_read(uc, UC_ARM_REG_S0 + static_cast<int>(n), &theirs);
    if (theirs != core.state().fpu.s(n)) return "s" + std::to_string(n);
  }
  uc_reg_read(uc, UC_ARM_REG_FPSCR, &theirs);
  return theirs != core.state().fpu.status().bits() ? "fpscr" : "";
}

/// Operations left out because the oracle has no system side, and its known faults by name.
inline bool outside_the_oracle(const DecodedOp& op) {
  switch (op.operation) {
    case Operation::svc:
    case Operation::bkpt:
    case Operation::cps:
    case Operation::mrs:
    case Operation::msr:
    case Operation::wfi:
    case Operation::wfe:
    case Operation::sev:
    case Operation::it:  // ITSTATE is not compared here, only by the agreement test
    case Operation::barrier:
    case Operation::isb:
    case Operation::clrex:
    case Operation::coprocessor:  // Unicorn knows coprocessors
      return true;
    default:
      return false;
  }
}

inline bool unpredictable(const DecodedOp& op) {
  return unpredictable_encoding(op).has_value();
}

/// The bits the manual writes as (1) and (0) in the encodings that have them.
inline uint32_t with_should_be_bits(const Encoding& e, uint32_t bits) {
  return (bits | e.ones) & ~e.zeros;
}

inline bool leaves(const DecodedOp& op) {
  // So does it with what follows a load-exclusive, which ends its translation block.
  bool exclusive = is(op, kind::exclusive_load);
  bool conditional = op.operation == Operation::bcond || op.operation == Operation::cbz ||
                     op.operation == Operation::cbnz;
  return exclusive || conditional || (op.operation != Operation::undefined && ends_block(op));
}

/// Encodings that Unicorn 2.0.1 executes with the Cortex-M3 model though its decode tables (A5.2,
/// A5.3) leave them UNDEFINED, or refuses though they are hints; by name and fixed bits.
struct KnownFault {
  const char* name;
  unsigned size;
  uint32_t mask, value;
};
constexpr KnownFault known_faults[] = {
    {"SETEND, of A and R profile, executes (A5.2.5)", 2, 0xFFF0, 0xB650},
    {"YIELD is invalid (A5.2.5)", 2, 0xFFFF, 0xBF10},
    {"YIELD.W is invalid (A5.3.4)", 4, 0xFFF0D7FF, 0xF3A08001},
    {"LDREXD and STREXD, of A and R profile, execute (A5.3.6)", 4, 0xFFE000F0, 0xE8C00070},
    {"BLX to the A32 instruction set executes (A5.3.4)", 4, 0xF800D001, 0xF000C000},
    {"SSAT16 and USAT16, of the DSP extension, execute (A5.3.3)", 4, 0xFF70F0C0, 0xF3200000},
    {"stores relative to the PC execute (A5.3.10)", 4, 0xFF1F0000, 0xF80F0000},
    {"Advanced SIMD loads and stores move their base (A5.3.1)", 4, 0xFF100000, 0xF9000000},
    {"SXTAB, SXTAH, UXTAB, UXTAH, of the DSP extension, execute (A5.3.12)", 4, 0xFFA0F0C0,
     0xFA00F080},
    {"SMUAD and SMLAD, of the DSP extension, execute (A5.3.16)", 4, 0xFFF000E0, 0xFB200000},
    {"SMULW and SMLAW, of the DSP extension, execute (A5.3.16)", 4, 0xFFF000E0, 0xFB300000},
    {"SMUSD and SMLSD, of the DSP extension, execute (A5.3.16)", 4, 0xFFF000E0, 0xFB400000},
    {"USAD8 and USADA8, of the DSP extension, execute (A5.3.16)", 4, 0xFFF000F0, 0xFB700000},
    {"SMLALD, of the DSP extension, executes (A5.3.17)", 4, 0xFFF000E0, 0xFBC000C0},
    {"SMLSLD, of the DSP extension, executes (A5.3.17)", 4, 0xFFF000E0, 0xFBD000C0},
};

/// Unicorn keeps the two lowest bits of R13, which read as zero (B1.4.1).
inline bool may_misalign_sp(const DecodedOp& op) {
  const bool moves_by_words =
      (op.operation == Operation::add_imm || op.operation == Operation::sub_imm) && op.rn == 13 &&
      (op.imm & 3) == 0;
  const Encoding& line = line_of(op);
  const bool to_sp =
      op.rd == 13 && (line.has('d') || line.has('e')) && op.operation != Operation::str;
  return (to_sp && !moves_by_words) ||
         (op.writeback && op.rn == 13 && (op.imm & 3) != 0 &&
          is(op, kind::load | kind::store | kind::dual_load | kind::dual_store));
}

/// Unicorn's Cortex-M0 executes CBZ, CBNZ and IT, which Armv6-M does not have (ARM DDI 0419,
/// A5.2.5).
inline bool is_main_alone(const DecodedOp& op) {
  const Encoding* line = find_encoding(op.encoding, op.size);
  return op.operation == Operation::undefined && op.size == 2 && line != nullptr &&
         line->set == instruction_set::v7m;
}

/// Unicorn rounds as FPSCR says what is always rounded to nearest (A7.7, "VCVT between
/// floating-point and fixed-point").
inline bool rounds_otherwise(const DecodedOp& op, const Core& core) {
  return op.operation == Operation::vcvt_from_fixed &&
         core.state().fpu.status().rounding() != Fpscr::Rounding::nearest;
}

inline bool known_fault(const DecodedOp& op) {
  if (is_main_alone(op)) return true;
  for (const KnownFault& fault : known_faults) {
    if (fault.size != op.size || (op.encoding & fault.mask) != fault.value) continue;
    if (op.operation == Operation::undefined || op.operation == Operation::nop) return true;
  }
  return op.operation != Operation::undefined && may_misalign_sp(op);
}

}  // namespace capsoc::armv7m::test
