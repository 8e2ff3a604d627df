// State of the processor's system blocks by name: interrupt controller, SysTick, system control
// block, memory protection unit.
#pragma once

#include <string>
#include <vector>

#include "armv7m/core.h"

namespace capsoc::inject {

/// Neighbouring bits that the profile has, of one value of the core's state.
struct SystemField {
  std::string name;  ///< "nvic.enabled", "mpu.rasr.3.size"
  std::string unit;  ///< "nvic"
  std::string path;  ///< of the value in the core's archive
  unsigned low = 0;  ///< its first bit there
  unsigned bits = 0;
};

/// Those of one core. Left out are what is read only for a cause (fault status), the SysTick's
/// counter, which is no state here, and DWT and ITM.
std::vector<SystemField> system_fields(const armv7m::Core& core);

/// The field's value, between two instructions.
uint32_t read_field(armv7m::Core& core, const SystemField& field);
/// Everything that depends on the state is determined again.
void write_field(armv7m::Core& core, const SystemField& field, uint32_t value);

}  // namespace capsoc::inject
