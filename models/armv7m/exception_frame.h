// The frame that exception entry stacks (ARM DDI 0403, B1.5.6 and B1.5.7).
#pragma once

#include <cstdint>

namespace capsoc::armv7m {

inline constexpr uint32_t exception_frame_bytes = 0x20;
/// xPSR.IPSR, the number of the exception that is executing; 0: Thread mode.
inline constexpr uint32_t exception_number_mask = 0x1FF;

/// Whether this stack pointer is the one after exception return has unstacked the frame there. The
/// frame may have a word for alignment.
constexpr bool is_unstacked(uint32_t stack_pointer, uint32_t frame) {
  const uint32_t bytes = stack_pointer - frame;
  return bytes == exception_frame_bytes || bytes == exception_frame_bytes + 4;
}

}  // namespace capsoc::armv7m
