#include "trace/exception_name.h"

#include "bus/address_map.h"
#include "soc/board_map.h"

namespace capsoc::trace {
namespace {

/// The outputs on a line, joined by "/".
std::string interrupt_name(int line) {
  std::string name;
  for (const bus::MapEntry& entry : soc::board_map()) {
    for (const bus::InterruptWire& wire : entry.interrupts) {
      if (wire.line != line) continue;
      if (!name.empty()) name += '/';
      name += wire.output == "interrupt" ? entry.name : entry.name + " " + wire.output;
    }
  }
  return name.empty() ? "interrupt " + std::to_string(line) : name;
}

}  // namespace

std::string exception_name(unsigned number) {
  switch (number) {
    case 0:
      return "Thread";
    case 1:
      return "Reset";
    case 2:
      return "NMI";
    case 3:
      return "HardFault";
    case 4:
      return "MemManage";
    case 5:
      return "BusFault";
    case 6:
      return "UsageFault";
    case 11:
      return "SVCall";
    case 12:
      return "DebugMonitor";
    case 14:
      return "PendSV";
    case 15:
      return "SysTick";
    default:
      return number < 16 ? "exception " + std::to_string(number)
                         : interrupt_name(static_cast<int>(number) - 16);
  }
}

}  // namespace capsoc::trace
