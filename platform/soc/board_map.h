// The board's address map.
#pragma once

#include <cstdint>

#include "bus/address_map.h"

namespace capsoc::soc {

/// Bytes.
inline constexpr uint64_t kib = 1024, mib = 1024 * kib;

/// Cycles that each word of a memory waits for beyond its own, by memory. The SRAMs of the board
/// answer at once. Its PSRAM is a 16-bit device of 70 ns: two halfwords of two cycles of 40 ns each
/// make a word, three cycles more than a transfer without waiting.
struct MemoryWaits {
  unsigned code_sram = 0, block_ram = 0, data_sram = 0, psram = 3;
};

/// The SoC: Arm MPS2 AN385 (as QEMU's mps2-an385 has it) with the coprocessor, the ADC front-end
/// and the clock controller in reserved APB slots 0xC to 0xE.
bus::AddressMap board_map(const MemoryWaits& waits = {});

}  // namespace capsoc::soc
