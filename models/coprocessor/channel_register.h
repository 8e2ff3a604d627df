// CHANNEL, which hardware of several channels has in addition to the registers of register_map.h.
// docs/reference/coprocessor.md, "Channels".
#pragma once

#include <cstdint>

#include "coprocessor/register_map.h"

namespace capsoc::coprocessor {

namespace channel {

inline constexpr uint32_t offset = description::CHANNEL_offset;
inline constexpr uint32_t window_mask = description::CHANNEL_WINDOW_mask;
inline constexpr uint32_t hold = description::CHANNEL_HOLD_mask;
inline constexpr uint32_t ready = description::CHANNEL_READY_mask;
inline constexpr uint32_t refused = description::CHANNEL_REFUSED_mask;
inline constexpr unsigned last_shift = description::CHANNEL_LAST_shift;
inline constexpr unsigned pending_shift = description::CHANNEL_PENDING_shift;

}  // namespace channel

// Hardware of several channels has CHANNEL there.
constexpr bool is_channel_register(uint32_t offset, unsigned channels) {
  return channels > 1 && offset == channel::offset;
}

// A register that the window shows of every channel alike.
constexpr bool is_shared(uint32_t offset) {
  return offset == reg_id || offset == reg_version || offset == reg_latency;
}

}  // namespace capsoc::coprocessor
