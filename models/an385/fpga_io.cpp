#include "an385/fpga_io.h"

namespace capsoc::an385 {
namespace {

using registers::Access;

using kit::all_bits;
constexpr uint32_t misc_bits = 0x3fb;  // chip selects and display lines; bit 2 is reserved

registers::RegisterDescription describe(const char* name, uint32_t offset, uint32_t bits,
                                        Access access = Access::read_write) {
  return {name, offset, access, 0, access == Access::read_only ? 0 : bits, 0, bits};
}

}  // namespace

FpgaIo::FpgaIo(const sc_core::sc_module_name& name)
    : RegisterBank(name, kit::device_size, kit::AccessRule::any_width, kit::Holes::reads_zero),
      LED0(*this, describe("LED0", 0x00, 3)),
      BUTTON(*this, describe("BUTTON", 0x08, 3, Access::read_only)),
      CLK1HZ(*this, describe("CLK1HZ", 0x10, all_bits)),
      CLK100HZ(*this, describe("CLK100HZ", 0x14, all_bits)),
      COUNTER(*this, describe("COUNTER", 0x18, all_bits)),
      PRESCALE(*this, describe("PRESCALE", 0x1c, all_bits)),
      PSCNTR(*this, describe("PSCNTR", 0x20, all_bits)),
      MISC(*this, describe("MISC", 0x4c, misc_bits)) {
  LED0.on_write([this](uint32_t value) {
    const uint32_t before = LED0.get();
    LED0.store(value);
    if (LED0.get() != before) leds(LED0.get());
  });
  count_time(CLK1HZ, 1, start_1hz_);
  count_time(CLK100HZ, 100, start_100hz_);
  COUNTER.on_peek([this] { return prescaled().counter; });
  PSCNTR.on_peek([this] { return prescaled().prescale_counter; });
  for (kit::Register* counting : {&COUNTER, &PRESCALE, &PSCNTR})
    counting->on_write([this, counting](uint32_t value) {
      hold_prescaled();
      counting->store(value);
    });
}

void FpgaIo::reset() {
  const uint32_t pressed = BUTTON.get();  // a finger does not know of resets
  const bool lit = LED0.get() != 0;
  reset_registers();
  BUTTON.set(pressed);
  start_1hz_ = ticks(1);
  start_100hz_ = ticks(100);
  anchor_cycle_ = board_clock_.cycles_at(access_time());
  if (lit) leds(0);
}

uint64_t FpgaIo::ticks(uint64_t hz) const {
  const sc_core::sc_time period = sc_core::sc_time(1, sc_core::SC_SEC) / static_cast<double>(hz);
  return access_time().value() / period.value();
}

void FpgaIo::count_time(kit::Register& counter, uint64_t hz, uint64_t& start) {
  counter.on_peek([this, hz, &start] { return static_cast<uint32_t>(ticks(hz) - start); });
  counter.on_write([this, hz, &start](uint32_t value) { start = ticks(hz) - value; });
}

FpgaIo::Prescaled FpgaIo::prescaled() const {
  const uint64_t elapsed = board_clock_.cycles_at(access_time()) - anchor_cycle_;
  const uint64_t left = PSCNTR.get();
  const uint64_t reload = PRESCALE.get();
  if (elapsed <= left) return {COUNTER.get(), static_cast<uint32_t>(left - elapsed)};
  // COUNTER steps together with each reload, the first of which comes one cycle after 0.
  const uint64_t beyond = elapsed - left - 1;
  const uint64_t reloads = 1 + beyond / (reload + 1);
  return {static_cast<uint32_t>(COUNTER.get() + reloads),
          static_cast<uint32_t>(reload - beyond % (reload + 1))};
}

void FpgaIo::hold_prescaled() {
  const Prescaled present = prescaled();
  COUNTER.set(present.counter);
  PSCNTR.set(present.prescale_counter);
  anchor_cycle_ = board_clock_.cycles_at(access_time());
}

void FpgaIo::visit(Archive& archive) {
  RegisterBank::visit(archive);
  archive("start_1hz", start_1hz_);
  archive("start_100hz", start_100hz_);
  archive("anchor_cycle", anchor_cycle_);
}

}  // namespace capsoc::an385
