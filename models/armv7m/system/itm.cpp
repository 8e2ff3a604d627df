#include "armv7m/system/itm.h"

#include "armv7m/profile.h"
#include "base/archive.h"

namespace capsoc::armv7m {
namespace {
constexpr uint32_t unlock_key = 0xC5ACCE55, tcr_itmena = 1;
constexpr uint32_t lsr_present = 1, lsr_locked = 2, fifo_ready = 1;
}  // namespace

void Itm::visit(Archive& archive) {
  archive("ter", ter_);
  archive("tpr", tpr_);
  archive("tcr", tcr_);
  archive("unlocked", unlocked_);
}

bool Itm::port_enabled(unsigned port, bool tracing) const {
  return tracing && (tcr_ & tcr_itmena) != 0 && ((ter_ >> port) & 1) != 0;
}

void Itm::enable(uint32_t which) {
  ter_ |= which;
  tcr_ |= tcr_itmena;
}

bool Itm::open_to_user(uint32_t address) const {
  const unsigned port = port_of(address);
  return port < ports && ((tpr_ >> (port / 8)) & 1) == 0;
}

uint32_t Itm::read(uint32_t address, bool tracing) const {
  const unsigned port = port_of(address);
  if (port < ports) return port_enabled(port, tracing) ? fifo_ready : 0;
  switch (address) {
    case ppb::ITM_TER:
      return ter_;
    case ppb::ITM_TPR:
      return tpr_;
    case ppb::ITM_TCR:
      return tcr_;
    case ppb::ITM_LSR:
      return unlocked_ ? lsr_present : lsr_present | lsr_locked;
    default:
      return 0;
  }
}

void Itm::write(uint32_t address, unsigned size, uint32_t value) {
  if (address == ppb::ITM_LAR) unlocked_ = value == unlock_key;
  if (!unlocked_ || size != 4) return;
  const auto stored = [&](uint32_t old) {
    return LaneWrite{value, 0xFFFFFFFF}.over(old, armv7m_registers.at(address));
  };
  switch (address) {
    case ppb::ITM_TER:
      ter_ = stored(ter_);
      break;
    case ppb::ITM_TPR:
      tpr_ = stored(tpr_);
      break;
    case ppb::ITM_TCR:
      tcr_ = stored(tcr_);
      break;
    default:
      break;
  }
}

}  // namespace capsoc::armv7m
