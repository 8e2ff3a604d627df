// A custom system-on-chip out of capsoc's models: processor, bus and memory as they are, a
// timer and a UART written for it. Nothing of platform/ is used.
#pragma once

#include <functional>
#include <string>

#include "armv7m/tlm/core_tlm.h"
#include "bus/ahb_matrix.h"
#include "bus/memory.h"
#include "kit/clocked_bank.h"

namespace own {

namespace kit = capsoc::kit;
using capsoc::registers::Access;

/// Interrupts every PERIOD cycles while CTRL is 1; a 1 written to PENDING clears it.
class Ticker : public kit::ClockedBank {
 public:
  Ticker(const sc_core::sc_module_name& name, kit::ClockDomain& clock) : ClockedBank(name, clock) {
    CTRL.on_write([this](uint32_t value) {
      CTRL.store(value);
      next_ = now() + PERIOD.get();
    });
    PENDING.on_write([this](uint32_t value) {
      PENDING.store(value);
      interrupt.set(PENDING.any(1));
    });
  }
  void visit(capsoc::Archive& archive) override {
    ClockedBank::visit(archive);
    archive("next", next_);
  }

  // name, offset, access, value at reset, bits that are writable, write-1-to-clear, readable
  kit::Register CTRL{*this, {"CTRL", 0x0, Access::read_write, 0, 1, 0, 1}};
  kit::Register PERIOD{*this, {"PERIOD", 0x4, Access::read_write, 1000, ~0U, 0, ~0U}};
  kit::Register PENDING{*this, {"PENDING", 0x8, Access::read_write, 0, 0, 1, 1}};
  kit::InterruptLine interrupt{*this, "interrupt"};

 private:
  void advance(uint64_t cycle) override {
    if (!CTRL.any(1) || next_ > cycle) return;
    const uint64_t period = std::max(PERIOD.get(), 1U);
    next_ += (cycle - next_) / period * period + period;
    PENDING.raise(1);
    interrupt.set(true);
  }
  uint64_t next_change() const override { return CTRL.any(1) ? next_ : never; }
  uint64_t next_ = 0;
};

/// Sends what is written to DATA at once.
class Printer : public kit::RegisterBank {
 public:
  Printer(const sc_core::sc_module_name& name, std::function<void(char)> sink)
      : RegisterBank(name, kit::device_size) {
    DATA.on_write([sink = std::move(sink)](uint32_t value) { sink(static_cast<char>(value)); });
  }
  kit::Register DATA{*this, {"DATA", 0x0, Access::write_only, 0, 0xFF, 0, 0}};
};

/// 64 KiB of RAM at 0, the timer at 0x40000000 on interrupt 0, the UART at 0x40001000.
class OwnSoc : public sc_core::sc_module {
 public:
  OwnSoc(const sc_core::sc_module_name& name, std::function<void(char)> sink)
      : sc_module(name), printer("printer", std::move(sink)) {
    cpu.icode.bind(ahb.i_code);
    cpu.dcode.bind(ahb.d_code);
    cpu.system.bind(ahb.system);
    ahb.port("ram")->bind(ram.socket);
    ahb.port("ticker")->bind(ticker.socket);
    ahb.port("printer")->bind(printer.socket);
    ticker.interrupt.connect([this](bool level) { cpu.set_interrupt(0, level); });
  }

  static capsoc::bus::AddressMap map() {
    using capsoc::bus::TargetKind;
    return {{"ram", "ram", 0x00000000, 0x10000, TargetKind::memory},
            {"ticker", "ticker", 0x40000000, 0x1000, TargetKind::device},
            {"printer", "printer", 0x40001000, 0x1000, TargetKind::device}};
  }

  kit::ClockDomain clock{50'000'000};
  capsoc::armv7m::CoreTlm cpu{"cpu", clock};
  capsoc::bus::AhbMatrix ahb{"ahb", map(), clock};
  capsoc::bus::Memory ram{"ram", 0x10000};
  Ticker ticker{"ticker", clock};
  Printer printer;
};

}  // namespace own
