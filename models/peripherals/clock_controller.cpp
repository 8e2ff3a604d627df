#include "peripherals/clock_controller.h"

#include "capsoc_registers.h"
#include "kit/register_table.h"

namespace capsoc::peripherals {

using namespace registers::clockctrl;
using kit::describe;

ClockController::ClockController(const sc_core::sc_module_name& name, kit::ClockDomain& clock)
    : RegisterBank(name, block_size, kit::AccessRule::word_only),
      id(*this, describe(table, ID_offset)),
      ctrl(*this, describe(table, CTRL_offset)),
      pll(*this, describe(table, PLL_offset)),
      status(*this, describe(table, STATUS_offset)),
      lock_time(*this, describe(table, LOCK_TIME_offset)),
      freq(*this, describe(table, FREQ_offset)),
      clock_(clock) {
  ctrl.on_write([this](uint32_t value) { write_ctrl(value); });
  pll.on_write([this](uint32_t value) { write_pll(value); });
  freq.on_peek([this] { return static_cast<uint32_t>(clock_.frequency_hz()); });

  sc_core::sc_spawn_options on_lock, on_switch;
  for (auto* each : {&on_lock, &on_switch}) {
    each->spawn_method();
    each->dont_initialize();
  }
  on_lock.set_sensitivity(&lock_event_);
  on_switch.set_sensitivity(&switch_event_);
  sc_core::sc_spawn([this] { reach_lock(); }, "reach_lock", &on_lock);
  sc_core::sc_spawn([this] { switch_output(); }, "switch_output", &on_switch);
}

void ClockController::reset() {
  cancel_lock();
  reset_registers();
  core_ = Pll();
  update();
}

void ClockController::write_ctrl(uint32_t value) {
  ctrl.store(value);
  const bool was_on = core_.enabled();
  core_.enable(ctrl.any(CTRL_PLL_EN_mask));
  core_.select(ctrl.any(CTRL_SELECT_mask));
  if (!core_.enabled()) cancel_lock();
  if (core_.enabled() && !was_on) start_lock();
  update();
}

void ClockController::write_pll(uint32_t value) {
  const uint32_t multiplier = (value & PLL_MULT_mask) >> PLL_MULT_shift;
  const uint32_t divider = (value & PLL_DIV_mask) >> PLL_DIV_shift;
  if (!core_.set_ratio(multiplier, divider)) {
    report("PLL ratio outside 1 to 200 MHz ignored");
    status.raise(STATUS_ERROR_mask);
    return;
  }
  const bool changed = pll.get() != value;
  pll.store(value);
  if (changed && core_.enabled()) start_lock();
  update();
}

// The reference drives HCLK while the PLL locks, and a write comes on an edge of HCLK: so the lock
// comes on one, too.
void ClockController::start_lock() {
  cancel_lock();
  if (lock_time.get() == 0) {
    core_.lock();
    return;
  }
  const sc_core::sc_time reference_period =
      sc_core::sc_time(1, sc_core::SC_SEC) / double(Pll::reference_hz);
  lock_at_ = access_time() + reference_period * double(lock_time.get());
  lock_event_.notify(lock_at_ - sc_core::sc_time_stamp());
}

void ClockController::cancel_lock() {
  lock_event_.cancel();
  lock_at_ = sc_core::sc_max_time();
}

void ClockController::reach_lock() {
  lock_at_ = sc_core::sc_max_time();
  core_.lock();
  update();
}

void ClockController::switch_output() {
  switch_at_ = sc_core::sc_max_time();
  if (clock_.frequency_hz() != core_.output_hz()) clock_.set_frequency(core_.output_hz());
}

void ClockController::update() {
  status.clear(STATUS_LOCKED_mask | STATUS_SELECTED_mask);
  if (core_.locked()) status.raise(STATUS_LOCKED_mask);
  if (core_.drives_output()) status.raise(STATUS_SELECTED_mask);
  const sc_core::sc_time ahead = access_time() - sc_core::sc_time_stamp();
  if (ahead == sc_core::SC_ZERO_TIME) {
    switch_output();
  } else {
    switch_event_.notify(ahead);
    switch_at_ = access_time();
  }
}

void ClockController::visit(Archive& archive) {
  RegisterBank::visit(archive);
  archive("core", core_);
  for (sc_core::sc_time* due : {&lock_at_, &switch_at_}) {
    uint64_t ticks = due->value();
    archive("due", ticks);
    *due = sc_core::sc_time::from_value(ticks);
  }
}

void ClockController::restored() {
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  const auto plan = [&now](sc_core::sc_event& event, const sc_core::sc_time& due) {
    event.cancel();
    if (due != sc_core::sc_max_time()) event.notify(due > now ? due - now : sc_core::SC_ZERO_TIME);
  };
  plan(lock_event_, lock_at_);
  plan(switch_event_, switch_at_);
}

}  // namespace capsoc::peripherals
