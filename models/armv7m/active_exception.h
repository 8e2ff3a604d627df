// The exception that a core executes, for its observers.
#pragma once

#include <cstdint>

#include "armv7m/core.h"
#include "armv7m/exception_frame.h"

namespace capsoc::armv7m {

/// Its number; 0: Thread mode.
inline unsigned active_exception(const Core& core) {
  return core.state().xpsr() & exception_number_mask;
}

/// Address of the frame that exception entry has just stacked.
inline uint32_t stacked_frame(const Core& core) {
  constexpr uint32_t thread_on_process_stack = 0xD;  // of EXC_RETURN
  const bool is_process_stack = (core.reg(14) & 0xFU) == thread_on_process_stack;
  return is_process_stack ? core.state().psp() : core.state().msp();
}

}  // namespace capsoc::armv7m
