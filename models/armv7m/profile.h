// Properties that differ between cores of the M-profile.
#pragma once

#include <array>
#include <cstdint>

#include "armv7m/isa/op.h"
#include "armv7m/isa/timing.h"

namespace capsoc::armv7m {

class SystemRegisters;
/// Of Armv7-M (ARM DDI 0403, B3 and C1), of Armv6-M (ARM DDI 0419, B3).
extern const SystemRegisters armv7m_registers, armv6m_registers;
/// Of Armv7-M with the floating-point extension.
extern const SystemRegisters armv7m_fp_registers;

/// The identification registers of a core (ARM DDI 0403, B3.2.3 and B4.1).
struct Identity {
  uint32_t cpuid = 0;
  /// ID_PFR0 at 0xE000ED40 and the words after it, up to ID_ISAR4; 0 where nothing is defined.
  std::array<uint32_t, 13> features{};

  /// The word at an address to which registers.def assigns the block `identity`.
  constexpr uint32_t word(uint32_t address) const {
    constexpr uint32_t first_feature = 0xE000ED40;
    if (address < first_feature) return cpuid;
    const uint32_t number = (address - first_feature) / 4;
    return number < features.size() ? features[number] : 0;
  }
};

/// Numbers of the special registers in MRS and MSR (ARM DDI 0403, B5.1.1).
namespace special {
enum Name : unsigned { primask = 16, basepri = 17, basepri_max = 18, faultmask = 19, control = 20 };
}  // namespace special

/// A core of the M-profile. The processor gets it at construction and never changes it. Everything
/// else is common to all cores (docs/reference/processor.md). The parts of the processor ask for
/// a property, never which core it is.
struct Profile {
  const char* name = "";
  const char* product = "";     ///< without the revision
  const char* short_name = "";  ///< as compilers and debuggers have it
  /// Sets of encodings (isa.def) that the core has. An instruction of another set is UNDEFINED to
  /// the decoder and thus to all executors.
  uint8_t instruction_sets = 0;
  /// Of the private peripheral bus. What a program cannot switch on because its register is not
  /// there stays off: configurable faults, the DebugMonitor, the MPU, the DWT.
  const SystemRegisters* registers = nullptr;
  uint32_t special_registers = 0;  ///< bit n: MRS and MSR know the one with number n
  uint32_t xpsr_bits = 0;          ///< those that exist
  /// Implemented bits of each priority: what there can be.
  unsigned least_priority_bits = 0, most_priority_bits = 0;
  bool has_bit_bands = false;     ///< aliases of single bits at 0x22000000 and 0x42000000
  bool has_write_buffer = false;  ///< the bus error of a store comes after its instruction
  /// CFSR and HFSR collect the causes of faults until a program clears them.
  bool has_fault_status = false;
  /// A fault of stacking on the way from HardFault to NMI ends in lockup, else NMI begins.
  bool locks_up_before_nmi = false;
  bool has_itm = false;  ///< stimulus ports that programs can write to
  Timing timing{};
  Identity identity{};

  constexpr bool has_dsp() const { return (instruction_sets & instruction_set::v7em) != 0; }
  constexpr bool has_fpu() const { return (instruction_sets & instruction_set::fpv4) != 0; }
  /// Of CONTROL: nPRIV, SPSEL and, with an FPU, FPCA.
  constexpr uint32_t control_bits() const { return has_fpu() ? 7 : 3; }
  constexpr bool has_special(unsigned number) const {
    return number < 32 && (special_registers >> number & 1) != 0;
  }
};

constexpr Profile make_cortex_m3() {
  Profile made{};
  made.name = "Cortex-M3 r2p1";
  made.product = "Cortex-M3";
  made.short_name = "cortex-m3";
  made.instruction_sets = instruction_set::v6m | instruction_set::v7m;
  made.registers = &armv7m_registers;
  made.special_registers = 0x1F03EF;
  made.xpsr_bits = 0xFF00FDFF;  // N Z C V Q, ICI/IT, T, nine bits of IPSR
  made.least_priority_bits = 3;
  made.most_priority_bits = 8;
  made.has_bit_bands = true;
  made.has_write_buffer = true;
  made.has_fault_status = true;
  made.has_itm = true;
  made.timing = cortex_m3_timing;
  made.identity.cpuid = 0x412FC231;
  made.identity.features = {0x30, 0x200,      0x00100000, 0,          0x30,       0,         0,
                            0,    0x01141110, 0x02111000, 0x21112231, 0x01111110, 0x01310102};
  return made;
}
inline constexpr Profile cortex_m3 = make_cortex_m3();

/// Without FPU: coprocessors 10 and 11 are as all others, and CPACR and FPCCR are not there.
constexpr Profile make_cortex_m4() {
  Profile made = make_cortex_m3();
  made.name = "Cortex-M4 r0p1";
  made.product = "Cortex-M4";
  made.short_name = "cortex-m4";
  made.instruction_sets |= instruction_set::v7em;
  made.xpsr_bits |= 0x000F0000;  // GE
  made.timing = cortex_m4_timing;
  made.identity.cpuid = 0x410FC241;  // DDI 0439D, table 4-1
  made.identity.features[9] = 0x02112000;
  made.identity.features[10] = 0x21232231;
  made.identity.features[11] = 0x01111131;
  return made;
}
inline constexpr Profile cortex_m4 = make_cortex_m4();

constexpr Profile make_cortex_m4f() {
  Profile made = make_cortex_m4();
  made.name = "Cortex-M4 r0p1 with FPU";
  made.product = "Cortex-M4 with FPU";
  made.short_name = "cortex-m4f";
  made.instruction_sets |= instruction_set::fpv4;
  made.registers = &armv7m_fp_registers;
  made.timing = cortex_m4f_timing;
  return made;
}
inline constexpr Profile cortex_m4f = make_cortex_m4f();

/// With the options of the fast multiplier, privilege levels, VTOR and SysTick; without an MPU.
constexpr Profile make_cortex_m0plus() {
  Profile made{};
  made.name = "Cortex-M0+ r0p1";
  made.product = "Cortex-M0+";
  made.short_name = "cortex-m0plus";
  made.instruction_sets = instruction_set::v6m;
  made.registers = &armv6m_registers;
  made.special_registers = 0x1103EF;  // without BASEPRI, BASEPRI_MAX, FAULTMASK
  made.xpsr_bits = 0xF100003F;        // N Z C V, T, six bits of IPSR
  made.least_priority_bits = 2;
  made.most_priority_bits = 2;
  made.locks_up_before_nmi = true;  // DDI 0484C, 3.6.1
  made.timing = cortex_m0plus_timing;
  made.identity.cpuid = 0x410CC601;
  return made;
}
inline constexpr Profile cortex_m0plus = make_cortex_m0plus();

}  // namespace capsoc::armv7m
