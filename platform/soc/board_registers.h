// All registers of the board by name, as the models declare them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kit/register_description.h"
#include "soc/soc.h"

namespace capsoc::soc {

struct RegisterField {
  std::string name;
  unsigned low = 0, bits = 1;
};

struct BoardRegister {
  std::string name;
  uint32_t address = 0;
  registers::RegisterDescription description;  ///< its name and offset are not those here
  bool reads_change = false;                   ///< reading it does something
  std::vector<RegisterField> fields;
};

struct BoardPeripheral {
  struct Block {
    uint32_t base, size;
  };
  struct Interrupt {
    std::string name;
    int line;
  };
  std::string name, description;
  std::vector<Block> blocks;  ///< the first one's base is the peripheral's
  std::vector<Interrupt> interrupts;
  std::vector<BoardRegister> registers;  ///< by address
};

/// Devices in the order of the address map, then the processor's own.
std::vector<BoardPeripheral> board_peripherals(const Soc& soc);

/// CMSIS-SVD 1.3 of all of them. Those of models/registers/capsoc.svd are as they are there.
std::string board_svd(const Soc& soc);

}  // namespace capsoc::soc
