#pragma once

#include <cstdint>
#include <systemc>

#include "peripherals/pll.h"
#include "tlm/clock_domain.h"
#include "tlm/register_bank.h"

namespace capsoc::peripherals {

/// The clock controller: software's view of the PLL, and the one that sets the frequency of HCLK (=
/// PCLK). Registers: models/registers/capsoc.svd, peripheral CLOCKCTRL.
class ClockController : public tlm_util::RegisterBank {
 public:
  /// `clock` is HCLK; it must outlive the controller and start with Pll::reference_hz.
  ClockController(const sc_core::sc_module_name& name, tlm_util::ClockDomain& clock);

  tlm_util::Register id;
  tlm_util::Register ctrl;
  tlm_util::Register pll;
  tlm_util::Register status;
  tlm_util::Register lock_time;
  tlm_util::Register freq;

  /// System reset: PLL off, HCLK from the reference.
  void reset();

 private:
  void write_ctrl(uint32_t value);
  void write_pll(uint32_t value);
  void start_lock();
  void reach_lock();
  void switch_output();
  void update();

  tlm_util::ClockDomain& clock_;
  Pll core_;
  sc_core::sc_event lock_event_;
  sc_core::sc_event switch_event_;
};

}  // namespace capsoc::peripherals
