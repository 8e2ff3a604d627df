// The Instrumentation Trace Macrocell's stimulus ports (ARM DDI 0403, C1.7): what a program writes
// there goes to whoever listens, at once, so that a port is always ready.
#include "cortex_m3/core.h"

namespace capsoc::cortex_m3 {
namespace {

constexpr uint32_t itm_base = 0xE0000000, ter = itm_base + 0xE00, tpr = itm_base + 0xE40,
                   tcr = itm_base + 0xE80, lar = itm_base + 0xFB0, lsr = itm_base + 0xFB4;
constexpr uint32_t unlock_key = 0xC5ACCE55, itmena = 1, trcena = 1u << 24;

}  // namespace

bool Core::in_itm(uint32_t address) {
  return address - itm_base < 0x1000;
}

bool Core::stimulus_enabled(unsigned port) const {
  return (state_.scb.demcr & trcena) != 0 && (state_.itm.tcr & itmena) != 0 &&
         ((state_.itm.ter >> port) & 1) != 0;
}

/// Ports can be open to the unprivileged, eight of them for each bit of TPR; the rest never is.
bool Core::itm_open_to_user(uint32_t address) const {
  const uint32_t port = (address - itm_base) / 4;
  return port < 32 && ((state_.itm.tpr >> (port / 8)) & 1) == 0;
}

uint32_t Core::itm_read(uint32_t address) const {
  const uint32_t port = (address - itm_base) / 4;
  if (port < 32) return stimulus_enabled(port) ? 1 : 0;  // FIFOREADY
  switch (address) {
    case ter:
      return state_.itm.ter;
    case tpr:
      return state_.itm.tpr;
    case tcr:
      return state_.itm.tcr;
    case lsr:
      return state_.itm.unlocked ? 1 : 3;
    default:
      return 0;
  }
}

/// `value` holds what was written, from bit 0.
void Core::itm_write(uint32_t address, unsigned size, uint32_t value) {
  const uint32_t port = (address - itm_base) / 4;
  if (port < 32) {
    if (stimulus_enabled(port) && stimulus_) stimulus_(port, value, size);
    return;
  }
  if (address == lar) state_.itm.unlocked = value == unlock_key;
  if (!state_.itm.unlocked || size != 4) return;
  switch (address) {
    case ter:
      state_.itm.ter = value;
      break;
    case tpr:
      state_.itm.tpr = value & 0xF;
      break;
    case tcr:
      state_.itm.tcr = value & 0x007F0F1F;
      break;
    default:
      break;
  }
}

}  // namespace capsoc::cortex_m3
