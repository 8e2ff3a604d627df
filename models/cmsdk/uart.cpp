#include "cmsdk/uart.h"

#include <fmt/format.h>

#include <algorithm>

#include "kit/guest_error.h"

namespace capsoc::cmsdk {
namespace {

using registers::Access;

constexpr registers::RegisterDescription state_description = {
    "STATE", 0x004, Access::read_write, 0, 0, Uart::state_tx_overrun | Uart::state_rx_overrun, 0xf};
constexpr registers::RegisterDescription uart_interrupts = {
    "INTSTATUS", 0x00c, Access::read_write, 0, 0, 0xf, 0xf};

}  // namespace

Uart::Uart(const sc_core::sc_module_name& name, kit::ClockDomain& clock)
    : kit::ClockedBank(name, clock),
      DATA(*this, describe_register("DATA", 0x000, Access::read_write, 0xff)),
      STATE(*this, state_description),
      CTRL(*this, describe_register("CTRL", 0x008, Access::read_write, 0x7f)),
      INTSTATUS(*this, uart_interrupts),
      BAUDDIV(*this, describe_register("BAUDDIV", 0x010, Access::read_write, 0xfffff)),
      id(*this, PartNumber::uart) {
  connect_registers();
}

void Uart::connect_registers() {
  DATA.on_peek([this] { return uint32_t{rx_buffer_}; });
  DATA.on_read([this] { return uint32_t{read_data()}; });
  DATA.on_write([this](uint32_t value) { write_data(static_cast<uint8_t>(value)); });
  for (kit::Register* each : {&STATE, &CTRL, &INTSTATUS, &BAUDDIV}) each->steady();
  STATE.on_write([this](uint32_t value) {
    STATE.store(value);
    update_interrupts();
  });
  CTRL.on_write([this](uint32_t value) { write_control(value); });
  INTSTATUS.on_peek([this] { return interrupt_status(); });
  INTSTATUS.on_write([this](uint32_t value) { write_interrupt_clear(value); });
  BAUDDIV.on_write([this](uint32_t value) {
    BAUDDIV.store(value);
    check_baud_rate();
    load_shifter(now());
    begin_reception(now());
  });
}

void Uart::reset() {
  reset_registers();
  shifting_ = false;
  if (receiving_) far_end_.pop_front();
  receiving_ = false;
  tx_buffer_ = shifter_ = rx_buffer_ = 0;
  update_interrupts();
  plan();
}

bool Uart::write_word(uint32_t offset, uint32_t value, uint32_t lanes) {
  if (offset == DATA.description().offset && (lanes & 0xff) == 0) {
    report("write to DATA without its low byte sends nothing");
    return true;
  }
  return ClockedBank::write_word(offset, value, lanes);
}

/// A byte for the empty buffer moves no line before it is sent, unless its way on into the shifter
/// is an interrupt.
bool Uart::takes_early(uint32_t offset, uint32_t value, uint32_t lanes) const {
  return offset == DATA.description().offset && (lanes & 0xff) != 0 && value <= 0xff &&
         !STATE.any(state_tx_full) && !CTRL.any(ctrl_tx_interrupt);
}

void Uart::write_data(uint8_t byte) {
  // The buffer takes the newer byte; the older one is what an overrun loses.
  if (STATE.any(state_tx_full)) {
    STATE.raise(state_tx_overrun);
    kit::guest_error_once(
        fmt::format("{} (transmit overrun)", name()),
        fmt::format("byte {:#04x} is written while STATE.TXFULL is 1, so {:#04x} before it is lost",
                    byte, tx_buffer_));
  }
  tx_buffer_ = byte;
  STATE.raise(state_tx_full);
  load_shifter(now());
  update_interrupts();
}

uint8_t Uart::read_data() {
  STATE.clear(state_rx_full);
  begin_reception(now());
  return rx_buffer_;
}

void Uart::write_control(uint32_t value) {
  CTRL.store(value);
  check_baud_rate();
  load_shifter(now());
  begin_reception(now());
  update_interrupts();
}

void Uart::check_baud_rate() {
  if (has_baud_rate() || !CTRL.any(ctrl_tx_enable | ctrl_rx_enable)) return;
  report(fmt::format("enabled with BAUDDIV {}: below {} there is no baud rate and nothing moves",
                     BAUDDIV.get(), minimum_baud_divider));
}

// The overrun interrupts are not latched: they are the STATE bits after their enables.
uint32_t Uart::interrupt_status() const {
  uint32_t overruns = 0;
  if (STATE.any(state_tx_overrun) && CTRL.any(ctrl_tx_overrun_interrupt))
    overruns |= interrupt_tx_overrun;
  if (STATE.any(state_rx_overrun) && CTRL.any(ctrl_rx_overrun_interrupt))
    overruns |= interrupt_rx_overrun;
  return INTSTATUS.get() | overruns;
}

void Uart::write_interrupt_clear(uint32_t value) {
  INTSTATUS.clear(value);
  if ((value & interrupt_tx_overrun) != 0) STATE.clear(state_tx_overrun);
  if ((value & interrupt_rx_overrun) != 0) STATE.clear(state_rx_overrun);
  update_interrupts();
}

void Uart::update_interrupts() {
  const uint32_t status = interrupt_status();
  tx_interrupt.set((status & interrupt_tx) != 0);
  rx_interrupt.set((status & interrupt_rx) != 0);
  overrun_interrupt.set((status & (interrupt_tx_overrun | interrupt_rx_overrun)) != 0);
  combined_interrupt.set(status != 0);
}

void Uart::load_shifter(uint64_t cycle) {
  if (shifting_ || !STATE.any(state_tx_full) || !CTRL.any(ctrl_tx_enable)) return;
  const bool high_speed = CTRL.any(ctrl_high_speed_test);
  if (!high_speed && !has_baud_rate()) return;
  shifter_ = tx_buffer_;
  shifting_ = true;
  shifted_at_ = cycle + uint64_t{bits_per_byte} * (high_speed ? 1 : BAUDDIV.get());
  STATE.clear(state_tx_full);
  // The transmit interrupt marks the buffer running empty, not the end of the byte.
  if (CTRL.any(ctrl_tx_interrupt)) INTSTATUS.raise(interrupt_tx);
}

void Uart::finish_transmission() {
  shifting_ = false;
  transmitted(shifter_);
  load_shifter(shifted_at_);
}

void Uart::flush() {
  advance(now());
  if (shifting_) transmitted(shifter_);
  if (STATE.any(state_tx_full) && CTRL.any(ctrl_tx_enable)) transmitted(tx_buffer_);
  shifting_ = false;
  STATE.clear(state_tx_full);
  plan();
}

void Uart::receive(uint8_t byte) {
  advance(now());
  far_end_.push_back(byte);
  begin_reception(now());
  plan();
}

void Uart::look_for_input() {
  advance(now());
  begin_reception(now());
  plan();
}

void Uart::ask_source() {
  if (!source_ || !far_end_.empty() || STATE.any(state_rx_full)) return;
  if (const std::optional<uint8_t> byte = source_()) far_end_.push_back(*byte);
}

void Uart::begin_reception(uint64_t cycle) {
  if (receiving_ || !CTRL.any(ctrl_rx_enable) || !has_baud_rate()) return;
  ask_source();
  if (far_end_.empty()) return;
  receiving_ = true;
  received_at_ = cycle + uint64_t{bits_per_byte} * BAUDDIV.get();
}

void Uart::finish_reception() {
  receiving_ = false;
  const uint8_t byte = far_end_.front();
  far_end_.pop_front();
  if (!CTRL.any(ctrl_rx_enable)) return;
  if (STATE.any(state_rx_full)) STATE.raise(state_rx_overrun);
  rx_buffer_ = byte;
  STATE.raise(state_rx_full);
  if (CTRL.any(ctrl_rx_interrupt)) INTSTATUS.raise(interrupt_rx);
  begin_reception(received_at_);
}

void Uart::advance(uint64_t cycle) {
  while (next_change() <= cycle) {
    if (shifting_ && (!receiving_ || shifted_at_ <= received_at_))
      finish_transmission();
    else
      finish_reception();
    update_interrupts();
  }
}

uint64_t Uart::next_change() const {
  return std::min(shifting_ ? shifted_at_ : never, receiving_ ? received_at_ : never);
}

void Uart::visit(Archive& archive) {
  ClockedBank::visit(archive);
  archive("tx_buffer", tx_buffer_);
  archive("shifter", shifter_);
  archive("shifting", shifting_);
  archive("shifted_at", shifted_at_);
  archive("rx_buffer", rx_buffer_);
  archive("far_end", far_end_);
  archive("receiving", receiving_);
  archive("received_at", received_at_);
  if (receiving_ && far_end_.empty()) archive.refuse("receives a byte that was not sent");
}

}  // namespace capsoc::cmsdk
