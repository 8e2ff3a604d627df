#include "cmsdk/gpio.h"

namespace capsoc::cmsdk {
namespace {

using registers::Access;
using registers::RegisterDescription;

constexpr uint32_t pin_bits = 0xffff;

// MASKLOWBYTE and MASKHIGHBYTE: address bits 9 to 2 are the mask of one byte of the port.
constexpr uint32_t low_mask_base = 0x400;
constexpr uint32_t high_mask_base = 0x800;
constexpr uint32_t mask_end = 0xc00;

constexpr RegisterDescription gpio_interrupts = {"INTSTATUS", 0x038,   Access::read_write, 0, 0,
                                                 pin_bits,    pin_bits};

RegisterDescription pin_register(const char* name, uint32_t offset) {
  return describe_register(name, offset, Access::read_write, pin_bits);
}

bool is_masked_access(uint32_t offset) {
  return offset >= low_mask_base && offset < mask_end;
}

uint16_t mask_of(uint32_t offset) {
  const uint32_t byte = (offset >> 2) & 0xff;
  return static_cast<uint16_t>(offset >= high_mask_base ? byte << 8 : byte);
}

constexpr uint16_t inverted(uint16_t bits) {
  return static_cast<uint16_t>(~bits);
}

}  // namespace

Gpio::Gpio(const sc_core::sc_module_name& name, kit::ClockDomain& clock)
    : kit::ClockedBank(name, clock),
      DATA(*this, pin_register("DATA", 0x000)),
      DATAOUT(*this, pin_register("DATAOUT", 0x004)),
      OUTENSET(*this, pin_register("OUTENSET", 0x010)),
      OUTENCLR(*this, pin_register("OUTENCLR", 0x014)),
      ALTFUNCSET(*this, pin_register("ALTFUNCSET", 0x018)),
      ALTFUNCCLR(*this, pin_register("ALTFUNCCLR", 0x01c)),
      INTENSET(*this, pin_register("INTENSET", 0x020)),
      INTENCLR(*this, pin_register("INTENCLR", 0x024)),
      INTTYPESET(*this, pin_register("INTTYPESET", 0x028)),
      INTTYPECLR(*this, pin_register("INTTYPECLR", 0x02c)),
      INTPOLSET(*this, pin_register("INTPOLSET", 0x030)),
      INTPOLCLR(*this, pin_register("INTPOLCLR", 0x034)),
      INTSTATUS(*this, gpio_interrupts),
      id(*this, PartNumber::gpio) {
  DATA.on_peek([this] { return uint32_t{sampled_at(now())}; });
  DATA.on_write([this](uint32_t value) { write_output(static_cast<uint16_t>(value)); });
  DATAOUT.on_write([this](uint32_t value) { write_output(static_cast<uint16_t>(value)); });
  connect_pair(OUTENSET, OUTENCLR, output_enable_);
  connect_pair(ALTFUNCSET, ALTFUNCCLR, alternate_function_);
  connect_pair(INTENSET, INTENCLR, interrupt_enable_);
  connect_pair(INTTYPESET, INTTYPECLR, interrupt_type_);
  connect_pair(INTPOLSET, INTPOLCLR, interrupt_polarity_);
  INTSTATUS.on_write([this](uint32_t value) {
    INTSTATUS.store(value);
    refresh();
  });
}

// Both registers of a pair read the same bits. They store nothing themselves: bytes that a narrow
// write leaves out then set and clear nothing.
void Gpio::connect_pair(kit::Register& set, kit::Register& clear, uint16_t& bits) {
  const auto peek = [&bits] { return uint32_t{bits}; };
  set.on_peek(peek);
  clear.on_peek(peek);
  set.on_write([this, &bits](uint32_t value) {
    bits = static_cast<uint16_t>(bits | value);
    refresh();
  });
  clear.on_write([this, &bits](uint32_t value) {
    bits = static_cast<uint16_t>(bits & ~value);
    refresh();
  });
}

void Gpio::reset() {
  reset_registers();
  output_enable_ = alternate_function_ = 0;
  interrupt_enable_ = interrupt_type_ = interrupt_polarity_ = 0;
  refresh();
  plan();
}

void Gpio::drive(uint16_t mask, uint16_t levels) {
  advance(now());
  outside_ = static_cast<uint16_t>((outside_ & ~mask) | (levels & mask));
  refresh();
  plan();
}

uint16_t Gpio::pins() const {
  const uint16_t mask = driven();
  return static_cast<uint16_t>((DATAOUT.get() & mask) | (outside_ & inverted(mask)));
}

bool Gpio::read_word(uint32_t offset, uint32_t& value, bool debug) {
  if (!is_masked_access(offset)) return ClockedBank::read_word(offset, value, debug);
  const uint16_t mask = mask_of(offset);
  const bool answered = ClockedBank::read_word(DATA.description().offset, value, debug);
  value &= mask;
  return answered;
}

bool Gpio::write_word(uint32_t offset, uint32_t value, uint32_t lanes) {
  if (!is_masked_access(offset)) return ClockedBank::write_word(offset, value, lanes);
  const uint32_t mask = mask_of(offset) & lanes;
  const uint32_t merged = (DATAOUT.get() & ~mask) | (value & mask);
  return ClockedBank::write_word(DATAOUT.description().offset, merged, 0xffffffff);
}

void Gpio::write_output(uint16_t value) {
  DATAOUT.set(value);
  DATA.set(value);  // what a narrow write to DATA keeps is the output, not the pins
  refresh();
}

// After anything that may move a pin or an interrupt.
void Gpio::refresh() {
  sample_pins();
  latch(active_levels());
  if (!outputs.watched() || (pins() == last_levels_ && driven() == last_driven_)) return;
  last_levels_ = pins();
  last_driven_ = driven();
  outputs(last_levels_, last_driven_);
}

void Gpio::sample_pins() {
  const uint16_t levels = pins();
  if (levels == last_pins_) return;
  last_pins_ = levels;
  const uint64_t visible_at = now() + synchroniser_cycles;
  // Two changes in one cycle are one sample.
  if (!synchroniser_.empty() && synchroniser_.back().visible_at == visible_at)
    synchroniser_.back().levels = levels;
  else
    synchroniser_.push_back({visible_at, levels});
}

uint16_t Gpio::sampled_at(uint64_t cycle) const {
  uint16_t levels = sampled_;
  for (const Sample& each : synchroniser_)
    if (each.visible_at <= cycle) levels = each.levels;
  return levels;
}

/// If the pins have no observer and none of them interrupts, only reads see them.
bool Gpio::takes_early(uint32_t offset, uint32_t value, uint32_t) const {
  return (offset == DATA.description().offset || offset == DATAOUT.description().offset) &&
         value <= pin_bits && !outputs.watched() && interrupt_enable_ == 0;
}

void Gpio::take(uint16_t levels) {
  const uint16_t rising = levels & inverted(sampled_);
  const uint16_t falling = sampled_ & inverted(levels);
  sampled_ = levels;
  const uint16_t edges = static_cast<uint16_t>((interrupt_polarity_ & rising) |
                                               (inverted(interrupt_polarity_) & falling));
  latch(static_cast<uint16_t>((interrupt_type_ & edges) | active_levels()));
}

uint16_t Gpio::active_levels() const {
  const uint16_t active = static_cast<uint16_t>(~(sampled_ ^ interrupt_polarity_));
  return active & inverted(interrupt_type_);
}

// Level interrupts are latched as well: they stay until cleared, and are back at once if cleared
// while the level lasts.
void Gpio::latch(uint16_t events) {
  INTSTATUS.raise(events & interrupt_enable_);
  update_interrupts();
}

void Gpio::update_interrupts() {
  if (INTSTATUS.get() == shown_interrupts_) return;
  shown_interrupts_ = INTSTATUS.get();
  for (unsigned pin = 0; pin < pin_count; ++pin) pin_interrupt[pin].set(INTSTATUS.any(1u << pin));
  combined_interrupt.set(INTSTATUS.any(pin_bits));
}

void Gpio::restored() {
  shown_interrupts_ = INTSTATUS.get();
  ClockedBank::restored();
}

void Gpio::advance(uint64_t cycle) {
  while (!synchroniser_.empty() && synchroniser_.front().visible_at <= cycle) {
    const uint16_t levels = synchroniser_.front().levels;
    synchroniser_.pop_front();
    take(levels);
  }
}

uint64_t Gpio::next_change() const {
  // Without interrupts nothing outside notices; reads advance first.
  if (synchroniser_.empty() || interrupt_enable_ == 0) return never;
  return synchroniser_.front().visible_at;
}

void Gpio::visit(Archive& archive) {
  if (!archive.loading()) advance(now());
  ClockedBank::visit(archive);
  archive("output_enable", output_enable_);
  archive("alternate_function", alternate_function_);
  archive("interrupt_enable", interrupt_enable_);
  archive("interrupt_type", interrupt_type_);
  archive("interrupt_polarity", interrupt_polarity_);
  archive("outside", outside_);
  archive("sampled", sampled_);
  archive("last_pins", last_pins_);
  archive("last_driven", last_driven_);
  archive("last_levels", last_levels_);
  archive("synchroniser", synchroniser_);
  archive("pin_interrupt", pin_interrupt);
}

}  // namespace capsoc::cmsdk
