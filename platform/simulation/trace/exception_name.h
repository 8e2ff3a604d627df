#pragma once

#include <string>

namespace capsoc::trace {

/// "SysTick", "coprocessor interrupt", "uart0 rx": what exception `number` is on the board.
std::string exception_name(unsigned number);

}  // namespace capsoc::trace
