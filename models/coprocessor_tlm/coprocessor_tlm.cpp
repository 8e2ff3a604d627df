#include "coprocessor_tlm/coprocessor_tlm.h"

#include <fmt/format.h>

#include <algorithm>

#include "capsoc_registers.h"

namespace capsoc::coprocessor {

CoprocessorTlm::CoprocessorTlm(const sc_core::sc_module_name& name, tlm_util::ClockDomain& clock,
                               Options options)
    : RegisterTarget(name, registers::coprocessor::block_size, tlm_util::AccessRule::word_only),
      clock_(clock),
      core_(options) {
  clock_.on_change([this] { follow(); });
  sc_core::sc_spawn_options method;
  method.spawn_method();
  method.dont_initialize();
  method.set_sensitivity(&event_);
  const auto on_event = [this] {
    catch_up();
    follow();
  };
  sc_core::sc_spawn(on_event, "on_event", &method);
}

bool CoprocessorTlm::sample(const peripherals::SensorSample& sample) {
  catch_up();
  const bool latched = core_.submit(last_cycle_, sample.u, sample.v, sample.clip);
  follow();
  return latched;
}

void CoprocessorTlm::reset() {
  catch_up();
  core_.reset();
  follow();
}

// An access with a delay may have carried the model ahead of simulated time; it waits there.
uint64_t CoprocessorTlm::present_cycle() {
  return std::max(last_cycle_, clock_.cycles_at(access_time()));
}

// Event by event, so that the observer misses no sample even when an access comes first in an
// instant.
void CoprocessorTlm::catch_up() {
  const uint64_t present = present_cycle();
  for (auto next = core_.next_event(); next && *next <= present; next = core_.next_event()) {
    const uint32_t before = core_.read(last_cycle_, reg_samples, true).value;
    last_cycle_ = *next;
    core_.advance(*next);
    const bool new_result = core_.read(*next, reg_samples, true).value != before;
    if (new_result && observer_) observer_(*next, core_.nodes());
  }
  last_cycle_ = present;
  core_.advance(present);
}

void CoprocessorTlm::follow() {
  interrupt.set(core_.interrupt());
  event_.cancel();
  const auto next = core_.next_event();
  if (!next) return;
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  const sc_core::sc_time due = clock_.time_of(*next);
  event_.notify(due > now ? due - now : sc_core::SC_ZERO_TIME);
}

bool CoprocessorTlm::read_word(uint32_t offset, uint32_t& value, bool debug) {
  if (!debug) catch_up();
  const RegisterAccess result = core_.read(last_cycle_, offset, debug);
  if (!debug) follow();
  value = result.value;
  if (!result.ok && !debug) report(fmt::format("read at 0x{:03x}, where no register is", offset));
  return result.ok;
}

bool CoprocessorTlm::write_word(uint32_t offset, uint32_t value, uint32_t /*lanes: always all*/) {
  catch_up();
  const bool mapped = core_.write(last_cycle_, offset, value);
  follow();
  if (!mapped) {
    report(fmt::format("write of 0x{:08x} at 0x{:03x}, where no register is", value, offset));
  } else if (!core_.guest_error().empty()) {
    report(fmt::format("write of 0x{:08x} at 0x{:03x}: {}", value, offset, core_.guest_error()));
  }
  return mapped;
}

}  // namespace capsoc::coprocessor
