// Properties that differ between cores of the architecture.
#pragma once

#include <array>
#include <cstdint>

#include "armv7m/isa/timing.h"

namespace capsoc::armv7m {

/// The identification registers of a core (ARM DDI 0403, B3.2.3 and B4.1).
struct Identity {
  uint32_t cpuid;
  /// ID_PFR0 at 0xE000ED40 and the words after it, up to ID_ISAR4; 0 where nothing is defined.
  std::array<uint32_t, 13> features;

  /// The word at an address to which registers.def assigns the block `identity`.
  constexpr uint32_t word(uint32_t address) const {
    constexpr uint32_t first_feature = 0xE000ED40;
    if (address < first_feature) return cpuid;
    const uint32_t number = (address - first_feature) / 4;
    return number < features.size() ? features[number] : 0;
  }
};

/// A core of the ARMv7-M architecture. The processor gets it at construction and never changes it.
/// Everything else is common to all cores (docs/reference/processor.md).
struct Profile {
  const char* name;
  /// Kinds of operations (isa/op.h) that the core has. An instruction of another kind is UNDEFINED
  /// to the decoder and thus to all executors.
  uint32_t instructions;
  Timing timing;
  Identity identity;
};

inline constexpr Profile cortex_m3{"Cortex-M3 r2p1",
                                   0xFFFFFFFF,
                                   cortex_m3_timing,
                                   {0x412FC231,
                                    {0x30, 0x200, 0x00100000, 0, 0x30, 0, 0, 0, 0x01141110,
                                     0x02111000, 0x21112231, 0x01111110, 0x01310102}}};

}  // namespace capsoc::armv7m
