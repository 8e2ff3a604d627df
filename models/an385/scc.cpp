#include "an385/scc.h"

#include <fmt/format.h>

namespace capsoc::an385 {
namespace {

using registers::Access;

using kit::all_bits;

constexpr uint32_t control_start = 1u << 31;
constexpr uint32_t control_write = 1u << 30;
constexpr uint32_t control_bits = control_start | control_write | 0x03f00fff;
constexpr uint32_t function_oscillator = 1;
constexpr uint32_t status_complete = 1u << 0;
constexpr uint32_t status_error = 1u << 1;
constexpr uint32_t dll_writable = 0xff000000;  // the mask of unlocked DLLs

// AN385: OSCCLK0 50 MHz, OSCCLK1 24.576 MHz (audio), OSCCLK2 25 MHz.
constexpr std::array<uint32_t, 3> oscillators_at_reset = {50'000'000, 24'576'000, 25'000'000};

registers::RegisterDescription describe(const char* name, uint32_t offset, Access access,
                                        uint32_t bits, uint32_t reset = 0) {
  return {name, offset, access, reset, access == Access::read_only ? 0 : bits, 0, bits};
}

}  // namespace

Scc::Scc(const sc_core::sc_module_name& name)
    : RegisterBank(name, kit::device_size, kit::AccessRule::any_width, kit::Holes::reads_zero),
      CFG_REG0(*this, describe("CFG_REG0", 0x000, Access::read_write, 1)),
      CFG_REG1(*this, describe("CFG_REG1", 0x004, Access::read_write, 0xff)),
      CFG_REG3(*this, describe("CFG_REG3", 0x00c, Access::read_only, 0xff)),
      CFG_REG4(*this, describe("CFG_REG4", 0x010, Access::read_only, 0xf, 2)),
      SYS_CFGDATA_RTN(*this, describe("SYS_CFGDATA_RTN", 0x0a0, Access::read_only, all_bits)),
      SYS_CFGDATA_OUT(*this, describe("SYS_CFGDATA_OUT", 0x0a4, Access::read_write, all_bits)),
      SYS_CFGCTRL(*this,
                  describe("SYS_CFGCTRL", 0x0a8, Access::read_write, control_bits, 0x00100000)),
      SYS_CFGSTAT(*this, describe("SYS_CFGSTAT", 0x0ac, Access::read_only, 3)),
      SCC_DLL(*this, {"SCC_DLL", 0x100, Access::read_write, 0xffff0001, dll_writable, 0, all_bits}),
      SCC_AID(*this, describe("SCC_AID", 0xff8, Access::read_only, all_bits, 0x00200008)),
      SCC_ID(*this, describe("SCC_ID", 0xffc, Access::read_only, all_bits, 0x41043850)),
      oscillators_(oscillators_at_reset) {
  CFG_REG0.on_write([this](uint32_t value) {
    CFG_REG0.store(value);
    if (CFG_REG0.any(1)) report("remapping block RAM to address 0 is not modelled");
  });
  CFG_REG1.on_write([this](uint32_t value) {
    const uint32_t before = CFG_REG1.get();
    CFG_REG1.store(value);
    if (CFG_REG1.get() != before) leds(CFG_REG1.get());
  });
  SYS_CFGCTRL.on_write([this](uint32_t value) { transfer(value); });
}

void Scc::reset() {
  const uint32_t switches = CFG_REG3.get();
  const bool lit = CFG_REG1.get() != 0;
  reset_registers();
  CFG_REG3.set(switches);
  oscillators_ = oscillators_at_reset;
  if (lit) leds(0);
}

void Scc::transfer(uint32_t control) {
  SYS_CFGSTAT.set(0);
  SYS_CFGCTRL.store(control & ~control_start);
  if ((control & control_start) == 0) return;
  const uint32_t function = control >> 20 & 0x3f;
  const uint32_t device = control & 0xfff;
  if (function != function_oscillator || device >= oscillators_.size()) {
    report(fmt::format("configuration transfer to function {} device {}, where nothing is",
                       function, device));
    SYS_CFGSTAT.set(status_complete | status_error);
    return;
  }
  if ((control & control_write) != 0) {
    oscillators_[device] = SYS_CFGDATA_OUT.get();
  } else {
    SYS_CFGDATA_RTN.set(oscillators_[device]);
  }
  SYS_CFGSTAT.set(status_complete);
}

void Scc::visit(Archive& archive) {
  RegisterBank::visit(archive);
  archive("oscillators", oscillators_);
}

}  // namespace capsoc::an385
