#include "armv7m/system/registers.h"

#include <array>

#include "armv7m/profile.h"

namespace capsoc::armv7m {
namespace {

using registers::Access;

constexpr uint32_t readable(Access access) {
  return access == Access::write_only ? 0 : 0xFFFFFFFF;
}

constexpr SystemRegister system_registers[] = {
#define SYSTEM_REGISTER(name, address, words, room, access, parts, reset, writable, ones)        \
  {{#name, (address)-SystemRegister::private_peripherals, Access::access, reset, writable, ones, \
    readable(Access::access)},                                                                   \
   Room::room,                                                                                   \
   parts,                                                                                        \
   words},
#include "armv7m/system/registers.def"
#undef SYSTEM_REGISTER
};

constexpr unsigned words_in_page = 1024;
using Page = std::array<uint8_t, words_in_page>;  // 0: none, else 1 + row

constexpr Page page_of(uint32_t page_address) {
  Page rows{};
  uint8_t number = 0;
  for (const SystemRegister& row : system_registers) {
    ++number;
    if (row.address() >> 12 != page_address >> 12) continue;
    for (unsigned word = 0; word < row.words; ++word)
      rows[((row.address() & 0xFFF) >> 2) + word] = number;
  }
  return rows;
}
static_assert(std::size(system_registers) < 256);

}  // namespace

const SystemRegister* find_system_register(uint32_t address) {
  static constexpr Page itm = page_of(ppb::ITM_STIM), dwt = page_of(ppb::DWT_CTRL),
                        control = page_of(ppb::CPUID);
  const Page* page = address >> 12 == ppb::ITM_STIM >> 12   ? &itm
                     : address >> 12 == ppb::DWT_CTRL >> 12 ? &dwt
                     : address >> 12 == ppb::CPUID >> 12    ? &control
                                                            : nullptr;
  const unsigned number = page == nullptr ? 0 : (*page)[(address & 0xFFF) >> 2];
  return number == 0 ? nullptr : &system_registers[number - 1];
}

}  // namespace capsoc::armv7m
