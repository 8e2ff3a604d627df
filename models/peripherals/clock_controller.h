#pragma once

#include <cstdint>
#include <systemc>

#include "kit/clock_domain.h"
#include "kit/register_bank.h"
#include "peripherals/pll.h"

namespace capsoc::peripherals {

/// The clock controller: software's view of the PLL, and the one that sets the frequency of HCLK (=
/// PCLK). Registers: models/registers/capsoc.svd, peripheral CLOCKCTRL.
class ClockController : public kit::RegisterBank {
 public:
  /// `clock` is HCLK; it must outlive the controller and start with Pll::reference_hz.
  ClockController(const sc_core::sc_module_name& name, kit::ClockDomain& clock);

  kit::Register id;
  kit::Register ctrl;
  kit::Register pll;
  kit::Register status;
  kit::Register lock_time;
  kit::Register freq;

  /// System reset: PLL off, HCLK from the reference.
  void reset() override;
  void visit(Archive& archive) override;
  void restored() override;

 private:
  void write_ctrl(uint32_t value);
  void write_pll(uint32_t value);
  void start_lock();
  void cancel_lock();
  void reach_lock();
  void switch_output();
  void update();

  kit::ClockDomain& clock_;
  Pll core_;
  sc_core::sc_event lock_event_;
  sc_core::sc_event switch_event_;
  // When they are due, if they are.
  sc_core::sc_time lock_at_ = sc_core::sc_max_time(), switch_at_ = sc_core::sc_max_time();
};

}  // namespace capsoc::peripherals
