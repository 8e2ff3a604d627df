// The CMSDK APB watchdog (Cortex-M System Design Kit technical reference manual, DDI 0479).
#pragma once

#include <cstdint>
#include <systemc>

#include "cmsdk/down_counter.h"
#include "cmsdk/id_registers.h"
#include "kit/clocked_bank.h"
#include "kit/interrupt_line.h"

namespace capsoc::cmsdk {

/// A 32-bit down-counter of PCLK cycles that runs while INTEN is set. It interrupts on its first
/// step to 0; if that has not been cleared when it gets there again, it raises its reset output (if
/// RESEN is set) and stops. INTCLR and the step that sets INTEN restart it from WDOGLOAD. While
/// locked, every register but WDOGLOCK ignores writes, which are reported.
class Watchdog : public kit::ClockedBank {
 public:
  static constexpr uint32_t control_interrupt = 1u << 0;
  static constexpr uint32_t control_reset = 1u << 1;
  static constexpr uint32_t unlock_word = 0x1acce551;

  Watchdog(const sc_core::sc_module_name& name, kit::ClockDomain& clock);

  void reset() override;
  void visit(Archive& archive) override;

  kit::InterruptLine interrupt{*this, "interrupt"};          ///< WDOGINT, the processor's NMI
  kit::InterruptLine reset_request{*this, "reset_request"};  ///< WDOGRES

  kit::Register LOAD;
  kit::Register VALUE;
  kit::Register CONTROL;
  kit::Register INTCLR;
  kit::Register RIS;
  kit::Register MIS;
  kit::Register LOCK;
  kit::Register ITCR;
  kit::Register ITOP;
  IdRegisters id;

 private:
  void advance(uint64_t cycle) override;
  uint64_t next_change() const override;
  bool write_word(uint32_t offset, uint32_t value, uint32_t lanes) override;
  void write_control(uint32_t value);
  void restart();
  void follow();
  bool masked_interrupt() const { return RIS.any(1) && CONTROL.any(control_interrupt); }

  DownCounter counter_;
  bool expired_ = false;  // reached 0 a second time
};

}  // namespace capsoc::cmsdk
