#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "debug/description.h"
#include "debug/target.h"

namespace capsoc::debug::test {

/// Registers, 64 KiB of memory at 0x20000000, and a record of what was asked.
class FakeTarget : public Target {
 public:
  static constexpr uint32_t base = 0x20000000, size = 65536;
  std::array<uint32_t, registers.size()> values{};
  std::string memory = std::string(size, '\0');
  std::vector<std::tuple<StopPoint, uint32_t, uint32_t>> points;
  int resets = 0;
  std::set<unsigned> missing;  ///< registers that the processor does not have
  bool has_fpu = false;

  bool has_register(unsigned index) override {
    return missing.count(index) == 0 && (has_fpu || index < first_fpu_register);
  }
  uint32_t read_register(unsigned index) override { return values.at(index); }
  void write_register(unsigned index, uint32_t value) override { values.at(index) = value; }
  std::string read_memory(uint32_t address, uint32_t length) override {
    if (address - base >= size) return "";
    return memory.substr(address - base, length);
  }
  bool write_memory(uint32_t address, const std::string& bytes) override {
    if (address - base >= size || bytes.size() > size - (address - base)) return false;
    std::copy(bytes.begin(), bytes.end(), memory.begin() + (address - base));
    return true;
  }
  bool set(StopPoint kind, uint32_t address, uint32_t length) override {
    points.emplace_back(kind, address, length);
    return true;
  }
  void clear(StopPoint kind, uint32_t address, uint32_t length) override {
    const auto found = std::find(points.begin(), points.end(), std::tuple{kind, address, length});
    if (found != points.end()) points.erase(found);
  }
  void reset() override { ++resets; }
  std::string state() override { return "Thread mode"; }
  std::vector<MemoryRange> memory_ranges() override { return {{base, size}, {0x20020000, 0x1000}}; }
};

}  // namespace capsoc::debug::test
