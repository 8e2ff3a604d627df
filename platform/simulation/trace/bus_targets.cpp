#include "trace/bus_targets.h"

#include <fmt/format.h>

#include <algorithm>

namespace capsoc::trace {

BusTargets::BusTargets(const std::vector<soc::BoardPeripheral>& registers) {
  for (const soc::BoardPeripheral& peripheral : registers)
    for (const soc::BoardRegister& each : peripheral.registers)
      registers_[each.address] = peripheral.name + "." + each.name;
}

std::string BusTargets::register_name(uint32_t address) const {
  const auto found = registers_.find(address & ~3u);
  return found == registers_.end() ? "" : found->second;
}

std::string BusTargets::place(uint32_t address) {
  if (last_ == nullptr || address < last_->base || address > last_->last()) {
    const auto found = std::find_if(map_.begin(), map_.end(), [address](const auto& entry) {
      return address >= entry.base && address <= entry.last();
    });
    last_ = found == map_.end() ? nullptr : &*found;
  }
  std::string text =
      last_ == nullptr ? "" : fmt::format("{}+{:#x}", last_->name, address - last_->base);
  if (const std::string name = register_name(address); !name.empty())
    text += (text.empty() ? "" : " ") + name;
  return text;
}

}  // namespace capsoc::trace
