// The frame that exception entry stacks (ARM DDI 0403, B1.5.6 and B1.5.7).
#pragma once

#include <cstdint>

namespace capsoc::armv7m {

inline constexpr uint32_t exception_frame_bytes = 0x20;
/// Of a frame with room for floating-point registers.
inline constexpr uint32_t extended_frame_bytes = 0x68;
/// xPSR.IPSR, the number of the exception that is executing; 0: Thread mode.
inline constexpr uint32_t exception_number_mask = 0x1FF;

/// EXC_RETURN, bit 4: 0 of an extended frame, on cores with an FPU; others have ones only.
inline constexpr uint32_t exc_return_basic_frame = 0x10;
constexpr uint32_t frame_bytes(uint32_t exc_return) {
  return (exc_return & exc_return_basic_frame) != 0 ? exception_frame_bytes : extended_frame_bytes;
}

/// Whether this stack pointer is the one after exception return has unstacked the frame there. The
/// frame may have a word for alignment. `extended`: it had floating-point registers, as
/// State::has_fp_context() says after the return.
constexpr bool is_unstacked(uint32_t stack_pointer, uint32_t frame, bool extended) {
  const uint32_t bytes = stack_pointer - frame;
  const uint32_t least = extended ? extended_frame_bytes : exception_frame_bytes;
  return bytes == least || bytes == least + 4;
}

}  // namespace capsoc::armv7m
