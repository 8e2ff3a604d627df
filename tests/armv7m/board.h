#pragma once

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "armv7m/core.h"
#include "loader/elf_image.h"

namespace capsoc::armv7m::test {

/// A core with the memories of the AN385 board at 0 and 0x20000000, and devices that read zero and
/// take everything. For whole programs without a simulation kernel.
class Board : public Bus {
 public:
  static constexpr uint32_t size = 4u << 20, ram_base = 0x20000000;
  std::vector<uint8_t> code = std::vector<uint8_t>(size), ram = std::vector<uint8_t>(size);
  Core core{*this};
  bool exited = false;

  explicit Board(const std::string& elf) {
    auto image = loader::load_elf(elf);
    loaded_ = static_cast<bool>(image);
    if (!loaded_) return;
    for (const loader::Segment& s : image.value().segments) {
      std::vector<uint8_t>& memory = s.address < ram_base ? code : ram;
      const uint32_t offset = s.address & (size - 1);
      if (offset + s.bytes.size() <= size)
        std::copy(s.bytes.begin(), s.bytes.end(), memory.begin() + offset);
    }
    core.map_memory(0, size, code.data(), true, 0);
    core.map_memory(ram_base, size, ram.data(), true, 0);
    core.listeners().semihosting = [this](Core&) {
      exited = true;
      return false;
    };
    core.reset();
  }
  bool loaded() const { return loaded_; }
  bool read(uint32_t, unsigned, uint32_t& value, unsigned&, AccessKind) override {
    value = 0;
    return true;
  }
  bool write(uint32_t, unsigned, uint32_t, unsigned&) override { return true; }

 private:
  bool loaded_ = false;
};

/// How long a random test runs: the number in an environment variable, else the short default.
inline unsigned long repetitions(const char* variable, unsigned long usual) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::strtoul(text, nullptr, 10) : usual;
}

}  // namespace capsoc::armv7m::test
