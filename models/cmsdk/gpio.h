// The CMSDK AHB GPIO (Cortex-M System Design Kit technical reference manual, DDI 0479).
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <systemc>

#include "cmsdk/id_registers.h"
#include "kit/clocked_bank.h"
#include "kit/interrupt_line.h"
#include "kit/probe.h"

namespace capsoc::cmsdk {

/// 16 pins. DATA reads the pins through a synchroniser of two flip-flops, so a change is visible,
/// and interrupts, two PCLK cycles later. A pin carries DATAOUT where OUTENABLE is set and the
/// alternate function is not selected, else the level that the outside drives (low if it is not
/// driven).
class Gpio : public kit::ClockedBank {
 public:
  static constexpr unsigned pin_count = 16;
  static constexpr uint64_t synchroniser_cycles = 2;

  Gpio(const sc_core::sc_module_name& name, kit::ClockDomain& clock);

  /// The outside drives the pins in `mask` to the levels in `levels`.
  void drive(uint16_t mask, uint16_t levels);

  /// Levels at the pins now.
  uint16_t pins() const;
  /// Pins that the port drives.
  uint16_t driven() const { return output_enable_ & static_cast<uint16_t>(~alternate_function_); }
  uint16_t alternate_functions() const { return alternate_function_; }

  /// Levels and the mask of driven pins, whenever one of the two changes.
  kit::Probe<uint16_t, uint16_t> outputs;

  /// System reset: all pins are inputs; the levels that the outside drives stay.
  void reset() override;
  void visit(Archive& archive) override;
  void restored() override;

  std::array<kit::InterruptLine, pin_count> pin_interrupt;
  kit::InterruptLine combined_interrupt{*this, "combined"};

  kit::Register DATA;
  kit::Register DATAOUT;
  kit::Register OUTENSET;
  kit::Register OUTENCLR;
  kit::Register ALTFUNCSET;
  kit::Register ALTFUNCCLR;
  kit::Register INTENSET;
  kit::Register INTENCLR;
  kit::Register INTTYPESET;  ///< 1: edge, 0: level
  kit::Register INTTYPECLR;
  kit::Register INTPOLSET;  ///< 1: rising or high, 0: falling or low
  kit::Register INTPOLCLR;
  kit::Register INTSTATUS;  ///< written: INTCLEAR
  IdRegisters id;

 private:
  struct Sample {
    uint64_t visible_at;  // edge
    uint16_t levels;
    void visit(Archive& archive) {
      archive("visible_at", visible_at);
      archive("levels", levels);
    }
  };

  bool read_word(uint32_t offset, uint32_t& value, bool debug) override;
  bool write_word(uint32_t offset, uint32_t value, uint32_t lanes) override;
  void advance(uint64_t cycle) override;
  uint64_t next_change() const override;
  bool takes_early(uint32_t offset, uint32_t value, uint32_t lanes) const override;

  void connect_pair(kit::Register& set, kit::Register& clear, uint16_t& bits);
  void write_output(uint16_t value);
  void refresh();
  void sample_pins();
  /// What DATA shows at an edge, whether advance() was there or not.
  uint16_t sampled_at(uint64_t cycle) const;
  void take(uint16_t levels);
  void latch(uint16_t events);
  uint16_t active_levels() const;
  void update_interrupts();

  uint16_t output_enable_ = 0;
  uint16_t alternate_function_ = 0;
  uint16_t interrupt_enable_ = 0;
  uint16_t interrupt_type_ = 0;
  uint16_t interrupt_polarity_ = 0;
  uint16_t outside_ = 0;
  uint16_t sampled_ = 0;           // what DATA shows
  uint16_t last_pins_ = 0;         // newest sample taken
  uint16_t last_driven_ = 0;       // told to the observer
  uint16_t last_levels_ = 0;       // told to the observer
  uint32_t shown_interrupts_ = 0;  // INTSTATUS as the lines have it
  std::deque<Sample> synchroniser_;
};

}  // namespace capsoc::cmsdk
