// Serial configuration controller of the MPS2 board (MPS2 technical reference manual 100112; values
// of the AN385 image).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <systemc>
#include <utility>

#include "kit/probe.h"
#include "kit/register_bank.h"

namespace capsoc::an385 {

/// Board identification, eight LEDs and switches, and the channel to the board's configuration
/// controller. Of the controller this model has only the three oscillators (function 1, devices 0
/// to 2, hertz). A transfer completes at once. CFG_REG0's remapping of block RAM to address 0 is
/// not modelled and reported when asked for.
class Scc : public kit::RegisterBank {
 public:
  explicit Scc(const sc_core::sc_module_name& name);

  void reset() override;
  void visit(Archive& archive) override;

  void set_switches(uint32_t switches) { CFG_REG3.set(switches & 0xff); }
  /// The LEDs after each change, bits 0 to 7.
  kit::Probe<uint32_t> leds;

  kit::Register CFG_REG0;
  kit::Register CFG_REG1;
  kit::Register CFG_REG3;
  kit::Register CFG_REG4;
  kit::Register SYS_CFGDATA_RTN;
  kit::Register SYS_CFGDATA_OUT;
  kit::Register SYS_CFGCTRL;
  kit::Register SYS_CFGSTAT;
  kit::Register SCC_DLL;
  kit::Register SCC_AID;
  kit::Register SCC_ID;

 private:
  void transfer(uint32_t control);

  std::array<uint32_t, 3> oscillators_{};  // Hz
};

}  // namespace capsoc::an385
