// The frame that exception entry stacks (ARM DDI 0403, B1.5.6 and B1.5.7), for observers that tell
// threads of a program by their stacks.
#pragma once

#include <cstdint>

#include "armv7m/core.h"

namespace capsoc::armv7m {

inline constexpr uint32_t exception_frame_bytes = 0x20;
/// xPSR.IPSR, the number of the exception that is executing; 0: Thread mode.
inline constexpr uint32_t exception_number_mask = 0x1FF;

inline unsigned active_exception(const Core& core) {
  return core.state().xpsr() & exception_number_mask;
}

/// Address of the frame that exception entry has just stacked.
inline uint32_t stacked_frame(const Core& core) {
  constexpr uint32_t thread_on_process_stack = 0xD;  // of EXC_RETURN
  const bool is_process_stack = (core.reg(14) & 0xFU) == thread_on_process_stack;
  return is_process_stack ? core.state().psp() : core.state().msp();
}

/// Whether this stack pointer is the one after exception return has unstacked the frame there. The
/// frame may have a word for alignment.
constexpr bool is_unstacked(uint32_t stack_pointer, uint32_t frame) {
  const uint32_t bytes = stack_pointer - frame;
  return bytes == exception_frame_bytes || bytes == exception_frame_bytes + 4;
}

}  // namespace capsoc::armv7m
