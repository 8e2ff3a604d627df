// The registers of the private peripheral bus, and the block of the processor that has each.
#pragma once

#include <cstdint>

#include "kit/register_description.h"

namespace capsoc::armv7m {

/// Addresses of the registers, under the manual's names.
namespace ppb {
enum Address : uint32_t {
#define SYSTEM_REGISTER(name, address, words, room, access, parts, reset, writable, ones) \
  name = (address),
#include "armv7m/system/registers.def"
#undef SYSTEM_REGISTER
};
}  // namespace ppb

/// The block that has a register; `constant`: it always reads as its reset value; `identity`: its
/// value is in the core's profile.
enum class Room : uint8_t {
  constant,
  identity,
  itm,
  dwt,
  systick,
  nvic,
  scb,
  exceptions,
  mpu,
  debug
};

/// One row of registers.def.
struct SystemRegister {
  registers::RegisterDescription description;  ///< its offset counts from 0xE0000000
  Room room;
  bool byte_accesses;
  unsigned words;

  constexpr uint32_t address() const { return private_peripherals + description.offset; }
  static constexpr uint32_t private_peripherals = 0xE0000000;
};

/// The register that holds the word of an address; null where there is none.
const SystemRegister* find_system_register(uint32_t address);

constexpr bool in_private_peripherals(uint32_t address) {
  return address >> 20 == SystemRegister::private_peripherals >> 20;
}
constexpr bool in_itm(uint32_t address) {
  return address - SystemRegister::private_peripherals < 0x1000;
}

/// A write of one word's byte lanes.
struct LaneWrite {
  uint32_t value = 0;  ///< at its place in the word; other lanes have any value
  uint32_t lanes = 0;  ///< mask of the bytes that are written

  uint32_t over(uint32_t old) const { return (old & ~lanes) | (value & lanes); }
  /// The value of the described register after this write.
  uint32_t over(uint32_t old, const SystemRegister& target) const {
    return registers::stored(target.description, old, value, lanes);
  }
};

}  // namespace capsoc::armv7m
