#pragma once

#include <cstring>
#include <functional>
#include <initializer_list>
#include <vector>

#include "armv7m/core.h"

namespace capsoc::armv7m::test {

/// A core with 64 KiB of code at 0, 64 KiB of RAM at 0x20000000 and one device page at 0x40000000,
/// whose writes call a hook.
class Bench : public Bus {
 public:
  static constexpr uint32_t ram_base = 0x20000000, program = 0x1000, stack = 0x20008000;
  static constexpr uint16_t stay = 0xE7FE;  ///< b .
  static constexpr uint32_t handler(unsigned exception) { return 0x4000 + 32 * exception; }
  std::vector<uint8_t> flash = std::vector<uint8_t>(65536), ram = std::vector<uint8_t>(65536);
  uint32_t device = 0;
  bool at_once = false;  ///< the device answers so
  unsigned asked = 0;    ///< whether it does
  std::function<void(uint32_t)> on_write;
  Core core;

  explicit Bench(unsigned wait_states = 0, const Profile& profile = cortex_m3)
      : core(*this, profile) {
    core.map_memory(0, 65536, flash.data(), false, wait_states);
    core.map_memory(ram_base, 65536, ram.data(), true, 0);
    word(0, stack);
    for (uint32_t n = 1; n < 48; ++n) word(4 * n, (n == 1 ? program : handler(n)) | 1);
    for (uint32_t n = 2; n < 48; ++n) code(handler(n), {0x4770});  // bx lr
  }
  bool read(uint32_t address, unsigned, uint32_t& value, unsigned& wait, AccessKind) override {
    wait = 3;
    value = device;
    return (address >> 12) == 0x40000;
  }
  bool write(uint32_t address, unsigned, uint32_t value, unsigned& wait) override {
    wait = 2;
    if ((address >> 12) != 0x40000) return false;
    device = value;
    if (on_write) on_write(value);
    return true;
  }
  bool read_at_once(uint32_t address, unsigned size, uint32_t& value, unsigned& wait) override {
    return answers_at_once(address) && read(address, size, value, wait, AccessKind::load);
  }
  bool write_at_once(uint32_t address, unsigned size, uint32_t value, unsigned& wait) override {
    return answers_at_once(address) && write(address, size, value, wait);
  }
  /// Three times out of four, whatever the program does.
  bool answers_at_once(uint32_t address) {
    return at_once && (address >> 12) == 0x40000 && ++asked % 4 != 0;
  }
  void word(uint32_t address, uint32_t value) { std::memcpy(&flash[address], &value, 4); }
  void code(uint32_t address, std::initializer_list<uint16_t> halfwords) {
    core.invalidate_code(address, 2 * static_cast<uint32_t>(halfwords.size()));
    for (uint16_t h : halfwords) {
      std::memcpy(&flash[address], &h, 2);
      address += 2;
    }
  }
  void start(std::initializer_list<uint16_t> halfwords) {
    code(program, halfwords);
    core.reset();
  }
  uint32_t peek(uint32_t address) {
    uint32_t value = 0;
    core.debug_read(address, &value, 4);
    return value;
  }
};

}  // namespace capsoc::armv7m::test
