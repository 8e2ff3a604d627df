#include "armv7m/system/registers.h"

#include <iterator>

#include "armv7m/profile.h"

namespace capsoc::armv7m {
namespace {

constexpr uint32_t readable(registers::Access access) {
  return access == registers::Access::write_only ? 0 : 0xFFFFFFFF;
}

#define SYSTEM_REGISTER(name, address, words, room, access, parts, reset, writable, ones)   \
  {{#name, (address)-SystemRegister::private_peripherals, registers::Access::access, reset, \
    writable, ones, readable(registers::Access::access)},                                   \
   Room::room,                                                                              \
   parts,                                                                                   \
   words},
constexpr SystemRegister of_armv7m[] = {
#include "armv7m/system/registers.def"
};
constexpr SystemRegister of_armv7m_fp[] = {
#include "armv7m/system/registers.def"
#include "armv7m/system/registers_fp.def"
};
constexpr SystemRegister of_armv6m[] = {
#include "armv7m/system/registers_armv6m.def"
};
#undef SYSTEM_REGISTER
static_assert(std::size(of_armv7m_fp) < 256 && std::size(of_armv6m) < 256);

}  // namespace

// The compiler makes them: cores may be built before anything is initialized.
constexpr SystemRegisters armv7m_registers(of_armv7m, std::size(of_armv7m));
constexpr SystemRegisters armv7m_fp_registers(of_armv7m_fp, std::size(of_armv7m_fp));
constexpr SystemRegisters armv6m_registers(of_armv6m, std::size(of_armv6m));

const SystemRegister* SystemRegisters::find(uint32_t address) const {
  const Page* page = address >> 12 == ppb::ITM_STIM >> 12   ? &itm_
                     : address >> 12 == ppb::DWT_CTRL >> 12 ? &dwt_
                     : address >> 12 == ppb::CPUID >> 12    ? &control_
                                                            : nullptr;
  const unsigned number = page == nullptr ? 0 : (*page)[(address & 0xFFF) >> 2];
  return number == 0 ? nullptr : &rows_[number - 1];
}

}  // namespace capsoc::armv7m
