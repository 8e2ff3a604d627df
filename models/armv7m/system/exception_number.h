#pragma once

namespace capsoc::armv7m {

/// Exceptions by number (ARM DDI 0403, B1.5.2).
namespace exception {
constexpr unsigned reset = 1, nmi = 2, hard_fault = 3, mem_manage = 4, bus_fault = 5,
                   usage_fault = 6, svcall = 11, debug_monitor = 12, pendsv = 14, systick = 15,
                   first_interrupt = 16;
constexpr unsigned interrupts = 32;
constexpr unsigned count = first_interrupt + interrupts;

constexpr bool is_fault(unsigned number) {
  return number >= hard_fault && number <= usage_fault;
}
}  // namespace exception

}  // namespace capsoc::armv7m
