// The CMSDK APB timer (Cortex-M System Design Kit technical reference manual, DDI 0479).
#pragma once

#include <cstdint>
#include <systemc>

#include "cmsdk/down_counter.h"
#include "cmsdk/id_registers.h"
#include "kit/clocked_bank.h"
#include "kit/interrupt_line.h"

namespace capsoc::cmsdk {

/// A 32-bit down-counter of PCLK cycles. It interrupts on the step from 1 to 0, stays at 0 for one
/// cycle and then takes RELOAD: a period is RELOAD + 1 cycles, and RELOAD 0 stops at 0 without
/// another interrupt. Writing RELOAD also sets the counter. The first step happens one cycle after
/// the access that enables.
///
/// EXTIN is not connected: with SELEXTEN or SELEXTCLK the timer stands still, and a guest error is
/// reported.
class Timer : public kit::ClockedBank {
 public:
  static constexpr uint32_t ctrl_enable = 1u << 0;
  static constexpr uint32_t ctrl_external_enable = 1u << 1;
  static constexpr uint32_t ctrl_external_clock = 1u << 2;
  static constexpr uint32_t ctrl_interrupt = 1u << 3;

  Timer(const sc_core::sc_module_name& name, kit::ClockDomain& clock);

  void reset() override;
  void visit(Archive& archive) override;

  kit::InterruptLine interrupt{*this, "interrupt"};

  kit::Register CTRL;
  kit::Register VALUE;
  kit::Register RELOAD;
  kit::Register INTSTATUS;  ///< written: INTCLEAR
  IdRegisters id;

 private:
  void advance(uint64_t cycle) override;
  uint64_t next_change() const override;

  DownCounter counter_;
};

}  // namespace capsoc::cmsdk
