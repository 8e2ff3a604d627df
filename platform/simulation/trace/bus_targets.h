// What an address of the board is called.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "bus/address_map.h"
#include "soc/board_map.h"
#include "soc/board_registers.h"

namespace capsoc::trace {

class BusTargets {
 public:
  /// `registers`: of the board, by their names.
  explicit BusTargets(const std::vector<soc::BoardPeripheral>& registers);

  /// "uart0+0x4 UART0.STATE", "ssram1+0x100"; "" where nothing is.
  std::string place(uint32_t address);
  /// "UART0.STATE"; "" for what is no register.
  std::string register_name(uint32_t address) const;

 private:
  bus::AddressMap map_ = soc::board_map();
  const bus::MapEntry* last_ = nullptr;
  std::unordered_map<uint32_t, std::string> registers_;
};

}  // namespace capsoc::trace
