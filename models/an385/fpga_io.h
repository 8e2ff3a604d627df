// FPGA system control and I/O of the MPS2 board (application note AN385, section on FPGA system
// control).
#pragma once

#include <cstdint>
#include <functional>
#include <systemc>
#include <utility>

#include "kit/clock_domain.h"
#include "kit/probe.h"
#include "kit/register_bank.h"

namespace capsoc::an385 {

/// Two user LEDs, two buttons, and four counters that nothing waits for: each is computed when it
/// is read. CLK1HZ and CLK100HZ count simulated time; COUNTER steps at the 25 MHz board clock
/// whenever the prescale counter passes 0, which then takes PRESCALE (a prescaler of 0 stays at 0:
/// COUNTER steps every cycle). The processor's clock does not matter.
class FpgaIo : public kit::RegisterBank {
 public:
  explicit FpgaIo(const sc_core::sc_module_name& name);

  void reset() override;
  void visit(Archive& archive) override;

  /// Buttons of the board, bit 0 and 1, 1 while pressed.
  void set_buttons(uint32_t pressed) { BUTTON.set(pressed & 3); }
  /// The LEDs after each change, bit 0 and 1.
  kit::Probe<uint32_t> leds;

  kit::Register LED0;
  kit::Register BUTTON;
  kit::Register CLK1HZ;
  kit::Register CLK100HZ;
  kit::Register COUNTER;
  kit::Register PRESCALE;
  kit::Register PSCNTR;
  kit::Register MISC;

 private:
  struct Prescaled {
    uint32_t counter;
    uint32_t prescale_counter;
  };

  /// A counter of simulated time: the tick number from which it counts.
  void count_time(kit::Register& counter, uint64_t hz, uint64_t& start);
  uint64_t ticks(uint64_t hz) const;
  Prescaled prescaled() const;
  void hold_prescaled();

  kit::ClockDomain board_clock_{25'000'000};
  uint64_t start_1hz_ = 0;
  uint64_t start_100hz_ = 0;
  uint64_t anchor_cycle_ = 0;  // COUNTER and PSCNTR hold their values at this edge
};

}  // namespace capsoc::an385
