// The registers of the private peripheral bus, and the block of the processor that has each.
#pragma once

#include <array>
#include <cstdint>

#include "kit/register_description.h"

namespace capsoc::armv7m {

/// Addresses of the registers, under the manual's names.
namespace ppb {
enum Address : uint32_t {
#define SYSTEM_REGISTER(name, address, words, room, access, parts, reset, writable, ones) \
  name = (address),
#include "armv7m/system/registers.def"
#include "armv7m/system/registers_fp.def"
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
  debug,
  fpu
};

/// One row of registers.def or registers_fp.def.
struct SystemRegister {
  registers::RegisterDescription description;  ///< its offset counts from 0xE0000000
  Room room;
  bool byte_accesses;
  unsigned words;

  constexpr uint32_t address() const { return private_peripherals + description.offset; }
  static constexpr uint32_t private_peripherals = 0xE0000000;
};

/// The registers that the cores of one architecture have.
class SystemRegisters {
 public:
  static constexpr unsigned words_in_page = 1024;
  using Page = std::array<uint8_t, words_in_page>;  // 0: none, else 1 + row

  constexpr SystemRegisters(const SystemRegister* rows, unsigned count)
      : rows_(rows),
        itm_(page_of(ppb::ITM_STIM, count)),
        dwt_(page_of(ppb::DWT_CTRL, count)),
        control_(page_of(ppb::CPUID, count)) {}

  /// The register that holds the word of an address; null where there is none.
  const SystemRegister* find(uint32_t address) const;
  /// One that is there.
  const SystemRegister& at(uint32_t address) const { return *find(address); }
  /// Whether an address has one.
  bool has(uint32_t address) const { return find(address) != nullptr; }

 private:
  constexpr Page page_of(uint32_t page_address, unsigned count) const {
    Page places{};
    for (unsigned row = 0; row < count; ++row) {
      if (rows_[row].address() >> 12 != page_address >> 12) continue;
      for (unsigned word = 0; word < rows_[row].words; ++word)
        places[((rows_[row].address() & 0xFFF) >> 2) + word] = static_cast<uint8_t>(row + 1);
    }
    return places;
  }

  const SystemRegister* rows_;
  Page itm_, dwt_, control_;
};

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
