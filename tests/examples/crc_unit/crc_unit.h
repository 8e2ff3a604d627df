// An APB peripheral: CRC-32 (IEEE 802.3) of the words written to DATA, an interrupt after COUNT.
#pragma once

#include "kit/register_bank.h"
#include "soc/soc.h"

class CrcUnit : public capsoc::kit::RegisterBank {
 public:
  explicit CrcUnit(const sc_core::sc_module_name& name) : RegisterBank(name, 0x1000) {
    DATA.on_write([this](uint32_t word) { take(word); });
    CRC.on_peek([this] { return ~state_; });
    COUNT.on_write([this](uint32_t count) {
      COUNT.store(count);
      interrupt.set(false);
    });
  }
  void reset() override {
    reset_registers();
    state_ = ~0U;
    interrupt.set(false);
  }

  // What a checkpoint keeps in addition to the registers.
  void visit(capsoc::Archive& archive) override {
    RegisterBank::visit(archive);
    archive("state", state_);
  }

  using Access = capsoc::registers::Access;
  // name, offset, access, value at reset, bits that are writable, write-1-to-clear, readable
  capsoc::kit::Register DATA{*this, {"DATA", 0x0, Access::write_only, 0, ~0U, 0, 0}};
  capsoc::kit::Register CRC{*this, {"CRC", 0x4, Access::read_only, 0, 0, 0, ~0U}};
  capsoc::kit::Register COUNT{*this, {"COUNT", 0x8, Access::read_write, 0, ~0U, 0, ~0U}};
  capsoc::kit::InterruptLine interrupt{*this, "interrupt"};

 private:
  void take(uint32_t word) {
    state_ ^= word;
    for (int bit = 0; bit < 32; ++bit) state_ = state_ >> 1 ^ ((state_ & 1) != 0 ? 0xEDB88320 : 0);
    if (COUNT.get() == 0) return;
    COUNT.set(COUNT.get() - 1);
    interrupt.set(COUNT.get() == 0);
  }
  uint32_t state_ = ~0U;
};

/// For soc::Config::devices; interrupt 25 is free on the board.
inline std::unique_ptr<capsoc::kit::RegisterTarget> make_crc_unit(capsoc::soc::Soc& soc) {
  auto unit = std::make_unique<CrcUnit>("crc_unit");
  unit->interrupt.connect([&soc](bool level) { soc.cpu.set_interrupt(25, level); });
  return unit;
}
