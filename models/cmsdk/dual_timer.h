// The CMSDK APB dual-input timer (Cortex-M System Design Kit technical reference manual, DDI 0479).
#pragma once

#include <cstdint>
#include <string>
#include <systemc>

#include "cmsdk/down_counter.h"
#include "cmsdk/id_registers.h"
#include "kit/clocked_bank.h"
#include "kit/interrupt_line.h"

namespace capsoc::cmsdk {

/// Two counters of PCLK cycles with a prescaler of 1, 16 or 256, each free-running, periodic or
/// one-shot, 16 or 32 bits wide. Each interrupts on the step from 1 to 0, stays at 0 for one step
/// and then takes LOAD (periodic) or all ones of its width (free-running). Writing LOAD also sets
/// the counter, writing BGLOAD does not. A periodic counter whose LOAD is 0, which the manual does
/// not permit, stands at 0.
class DualTimer : public kit::ClockedBank {
 public:
  static constexpr uint32_t control_one_shot = 1u << 0;
  static constexpr uint32_t control_32_bit = 1u << 1;
  static constexpr uint32_t control_prescale = 3u << 2;
  static constexpr uint32_t control_interrupt = 1u << 5;
  static constexpr uint32_t control_periodic = 1u << 6;
  static constexpr uint32_t control_enable = 1u << 7;

  DualTimer(const sc_core::sc_module_name& name, kit::ClockDomain& clock);

  void reset() override;
  void visit(Archive& archive) override;

  /// TIMINTC: either timer's masked interrupt.
  kit::InterruptLine interrupt{*this, "interrupt"};

  /// The registers of one of the two; names carry its number, as in the manual.
  struct Unit {
    Unit(DualTimer& owner, unsigned number);

    kit::Register LOAD;
    kit::Register VALUE;
    kit::Register CONTROL;
    kit::Register INTCLR;
    kit::Register RIS;
    kit::Register MIS;
    kit::Register BGLOAD;

   private:
    friend class DualTimer;
    void reset();
    void advance(uint64_t cycle);
    bool masked_interrupt() const { return RIS.any(1) && CONTROL.any(control_interrupt); }
    bool wide() const { return CONTROL.any(control_32_bit); }
    uint32_t width_mask() const { return wide() ? 0xffffffff : 0xffff; }
    uint32_t shown(uint32_t count) const;
    void write_load(uint32_t value);
    void write_control(uint32_t value);
    void configure();

    DualTimer& owner_;
    DownCounter counter_;
    uint32_t upper_ = 0xffff0000;  // VALUE's upper half while the counter is 16 bits wide
  };

  Unit timer1;
  Unit timer2;
  kit::Register ITCR;
  kit::Register ITOP;
  IdRegisters id;

 private:
  void advance(uint64_t cycle) override;
  uint64_t next_change() const override;
  void follow();
};

}  // namespace capsoc::cmsdk
