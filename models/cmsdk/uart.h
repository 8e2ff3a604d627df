// The CMSDK APB UART (Cortex-M System Design Kit technical reference manual, DDI 0479).
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <systemc>

#include "cmsdk/id_registers.h"
#include "kit/clocked_bank.h"
#include "kit/interrupt_line.h"
#include "kit/probe.h"

namespace capsoc::cmsdk {

/// 8 data bits, no parity, one stop bit; one byte of buffer in each direction. A byte occupies the
/// line for ten bits of BAUDDIV PCLK cycles (one cycle a bit when transmitting with HSTEST), and
/// back-to-back bytes follow one another without a gap. A byte under way keeps the rate it began
/// with. BAUDDIV below 16 is no baud rate: nothing is transferred, and a guest error is reported.
class Uart : public kit::ClockedBank {
 public:
  static constexpr uint32_t state_tx_full = 1u << 0;
  static constexpr uint32_t state_rx_full = 1u << 1;
  static constexpr uint32_t state_tx_overrun = 1u << 2;
  static constexpr uint32_t state_rx_overrun = 1u << 3;
  static constexpr uint32_t ctrl_tx_enable = 1u << 0;
  static constexpr uint32_t ctrl_rx_enable = 1u << 1;
  static constexpr uint32_t ctrl_tx_interrupt = 1u << 2;
  static constexpr uint32_t ctrl_rx_interrupt = 1u << 3;
  static constexpr uint32_t ctrl_tx_overrun_interrupt = 1u << 4;
  static constexpr uint32_t ctrl_rx_overrun_interrupt = 1u << 5;
  static constexpr uint32_t ctrl_high_speed_test = 1u << 6;
  static constexpr uint32_t interrupt_tx = 1u << 0;
  static constexpr uint32_t interrupt_rx = 1u << 1;
  static constexpr uint32_t interrupt_tx_overrun = 1u << 2;
  static constexpr uint32_t interrupt_rx_overrun = 1u << 3;
  static constexpr uint32_t minimum_baud_divider = 16;
  static constexpr unsigned bits_per_byte = 10;  ///< start bit, 8 data bits, stop bit

  Uart(const sc_core::sc_module_name& name, kit::ClockDomain& clock);

  /// Each byte in the cycle in which its stop bit ends.
  kit::Probe<uint8_t> transmitted;

  /// The far end sends a byte. Bytes queue at the far end, which waits for an enabled receiver with
  /// a legal baud rate before it begins the next one. It never waits for the receive buffer:
  /// software that is too slow sees RXOVERRUN and the newer byte. A byte whose receiver is disabled
  /// before its stop bit is lost.
  void receive(uint8_t byte);

  /// The far end waits for the program, too, as with RTS and CTS: `source` is asked for a byte
  /// whenever the enabled receiver is idle and its buffer empty, so none overruns. Where it has
  /// none, look_for_input() makes the receiver ask again.
  void set_source(std::function<std::optional<uint8_t>()> source) { source_ = std::move(source); }
  void look_for_input();

  /// The byte in the shifter and the one in the buffer go to the sink at once, for the end of a
  /// run.
  void flush();

  /// Nothing in the buffer and nothing on the line.
  bool transmitter_idle() const { return !shifting_ && !STATE.any(state_tx_full); }

  /// System reset: what is on the line is lost, what waits at the far end is not.
  void reset() override;
  void visit(Archive& archive) override;

  kit::InterruptLine rx_interrupt{*this, "rx"};
  kit::InterruptLine tx_interrupt{*this, "tx"};
  kit::InterruptLine overrun_interrupt{*this, "overrun"};  ///< transmit or receive overrun
  kit::InterruptLine combined_interrupt{*this, "combined"};

  kit::Register DATA;
  kit::Register STATE;
  kit::Register CTRL;
  kit::Register INTSTATUS;  ///< written: INTCLEAR
  kit::Register BAUDDIV;
  IdRegisters id;

 private:
  bool write_word(uint32_t offset, uint32_t value, uint32_t lanes) override;
  bool takes_early(uint32_t offset, uint32_t value, uint32_t lanes) const override;
  void advance(uint64_t cycle) override;
  uint64_t next_change() const override;
  void connect_registers();

  void write_data(uint8_t byte);
  uint8_t read_data();
  void write_control(uint32_t value);
  void write_interrupt_clear(uint32_t value);
  uint32_t interrupt_status() const;
  void update_interrupts();
  void check_baud_rate();

  bool has_baud_rate() const { return BAUDDIV.get() >= minimum_baud_divider; }
  void load_shifter(uint64_t cycle);
  void finish_transmission();
  void ask_source();
  void begin_reception(uint64_t cycle);
  void finish_reception();

  std::function<std::optional<uint8_t>()> source_;
  uint8_t tx_buffer_ = 0;
  uint8_t shifter_ = 0;
  bool shifting_ = false;
  uint64_t shifted_at_ = 0;  // edge at which the stop bit ends
  uint8_t rx_buffer_ = 0;
  std::deque<uint8_t> far_end_;  // the front one is on the line while receiving_
  bool receiving_ = false;
  uint64_t received_at_ = 0;
};

}  // namespace capsoc::cmsdk
