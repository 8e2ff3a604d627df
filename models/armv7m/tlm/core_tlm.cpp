#include "armv7m/tlm/core_tlm.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "kit/guest_error.h"

namespace capsoc::armv7m {
namespace {

/// What the core executes at once, however long the quantum is: a tenth of a second of the host
/// where every instruction is traced.
constexpr uint64_t longest_run = 1U << 16U;
/// Cycles after which a program that never needs the kernel (it reads devices that have no events)
/// gives way to it: 10 ms at the board's 25 MHz.
constexpr uint64_t longest_ahead = 1U << 18U;

void log_unpredictable(Unpredictable which, uint32_t address) {
  const UnpredictableCase& c = describe(which);
  // One source a case: each is reported once, so that none is left out.
  const std::string source = fmt::format("cpu: {}", c.name);
  const std::string text = fmt::format("UNPREDICTABLE (ARM DDI 0403, {}) at {:#010x}: {}; here: {}",
                                       c.section, address, c.what, c.choice);
  // Schedulers begin their tasks so: they stack a function's address as C has it.
  if (which == Unpredictable::return_address) return kit::guest_note(source, text);
  kit::guest_error(source, text);
}

}  // namespace

CoreTlm::CoreTlm(const sc_core::sc_module_name& name, kit::ClockDomain& clock,
                 const Profile& profile)
    : sc_module(name),
      icode("icode"),
      dcode("dcode"),
      system("system"),
      clock_(clock),
      core_(*this, profile),
      horizon_(clock, core_),
      bus_({icode, dcode, system}, clock, core_, horizon_),
      polling_(core_),
      sleep_(clock, core_, horizon_, *this) {
  icode.register_invalidate_direct_mem_ptr(this, &CoreTlm::invalidate, 0);
  dcode.register_invalidate_direct_mem_ptr(this, &CoreTlm::invalidate, 1);
  system.register_invalidate_direct_mem_ptr(this, &CoreTlm::invalidate, 2);
  // SysTick's reference clock is 1 MHz whatever HCLK does (AN385).
  clock_.on_change([this] {
    core_.set_systick_reference(static_cast<unsigned>(clock_.frequency_hz() / 1'000'000));
    horizon_.clock_changed();
    core_.attention();  // the horizon is another cycle now
  });
  core_.listeners().unpredictable = log_unpredictable;
  SC_HAS_PROCESS(CoreTlm);
  SC_THREAD(thread);
}

void CoreTlm::set_interrupt(unsigned line, bool level) {
  if (interrupt_gate_ && !interrupt_gate_(line, level)) return;
  core_.set_interrupt(line, level);
  sleep_.wake();
}

void CoreTlm::pulse_nmi() {
  core_.pulse_nmi();
  sleep_.wake();
}

void CoreTlm::request_reset() {
  reset_requested_ = true;
  core_.attention();
  sleep_.wake();
}

void CoreTlm::reset_system() {
  reset_requested_ = false;
  polling_.forget_read();
  note_work();
  if (reset_request_) reset_request_();
  core_.reset();
}

void CoreTlm::set_pause(const sc_core::sc_time& first, Pause pause) {
  pause_ = std::move(pause);
  horizon_.set_pause(first);
}

void CoreTlm::resume_at(const sc_core::sc_time& time, std::function<bool()> load) {
  resume_at_ = time;
  load_ = std::move(load);
}

void CoreTlm::visit(Archive& archive) {
  archive("core", core_);
  archive("reset_requested", reset_requested_);
  bus_.visit(archive);
  sleep_.visit(archive);
}

void CoreTlm::restored() {
  bus_.remap();
  core_.memory_changed();
}

/// Out of reset, or out of saved state.
bool CoreTlm::begin() {
  if (!load_) {
    core_.reset();
    return true;
  }
  if (resume_at_ > sc_core::sc_time_stamp()) wait(resume_at_ - sc_core::sc_time_stamp());
  const std::function<bool()> load = std::exchange(load_, nullptr);
  return load();
}

void CoreTlm::pause_if_due() {
  if (horizon_.pause_at() > sc_core::sc_time_stamp()) return;
  if (!pause_) return horizon_.plan_pause(sc_core::sc_max_time());
  // Of one that was asked for just now the core knew nothing: it may be ahead of the kernel.
  horizon_.synchronise();
  horizon_.catch_up();
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  while (horizon_.pause_at() <= now) {
    horizon_.plan_pause(sc_core::sc_max_time());
    polling_.forget_read();
    horizon_.give_way();
    horizon_.plan_pause(std::max(pause_(now), now + sc_core::sc_time::from_value(1)));
  }
}

void CoreTlm::thread() {
  if (!begin()) return end(EndReason::interrupted);
  bool stays = false;  // the kernel has not run, and no other component has done anything
  for (;;) {
    const bool is_alone = core_.cycles() - asked_at_ < longest_ahead && !is_called();
    if (stays && (!is_alone || is_watched())) {
      horizon_.synchronise();
      horizon_.catch_up();
      stays = false;
    }
    if (!stays) {
      horizon_.settle();
      if (sc_core::sc_get_status() == sc_core::SC_STOPPED) return;
      if (is_interrupted()) return end(EndReason::interrupted);
      pause_if_due();
      if (reset_requested_) reset_system();
    }
    bool one = false;
    if (debugger_ != nullptr && !stays) {
      one = debugger_->before_run();
      if (debugger_->ended()) return end(EndReason::debugger);
      horizon_.settle();  // what it wrote to a device
    }
    const uint64_t cycles = core_.cycles(), instructions = core_.instructions();
    if (!std::exchange(stays, false)) horizon_.look_ahead();
    const uint64_t longest =
        debugger_ != nullptr ? std::min(longest_run, debugger_->longest_run()) : longest_run;
    const uint64_t until = horizon_.begin_run(longest);
    if (core_.cycles() >= until) {
      horizon_.synchronise();
      horizon_.catch_up();
      continue;
    }
    const StopReason reason = one ? core_.step_instruction() : core_.run(until);
    const bool advanced = core_.cycles() != cycles || core_.instructions() != instructions;
    // The kernel may stay where it is until something happens in it.
    const bool may_stay = (reason == StopReason::attention || reason == StopReason::budget) &&
                          !reset_requested_ && !is_watched();
    stays = may_stay && !horizon_.is_late();
    if (may_stay)
      horizon_.follow();
    else
      horizon_.synchronise();
    horizon_.catch_up();
    const bool polls = polling_.seems_to_poll();
    polling_.clear();
    if (polls && reason == StopReason::attention && !(stays && skip_known_turns())) {
      skip_polling();
      stays = false;
    }
    if (debugger_ != nullptr && debugger_->after_run(reason, advanced)) continue;
    attend_to(reason);
    if (end_reason_ != EndReason::none) return;
  }
}

void CoreTlm::attend_to(StopReason reason) {
  switch (reason) {
    case StopReason::sleeping:
      polling_.forget_read();
      if (const EndReason ends = sleep_.until_woken(); ends != EndReason::none) end(ends);
      break;
    case StopReason::lockup:
      return end(EndReason::lockup);
    case StopReason::stuck:
      return end(EndReason::stuck);
    case StopReason::semihosting_exit:
      return end(EndReason::exit);
    case StopReason::reset_request:
      reset_system();
      break;
    case StopReason::semihosting_waits:
    case StopReason::budget:
    case StopReason::attention:
    case StopReason::breakpoint:
    case StopReason::watchpoint:
      break;
  }
}

bool CoreTlm::is_interrupted() {
  called_.store(false, std::memory_order_relaxed);
  asked_at_ = core_.cycles();
  return interrupted_ && interrupted_();
}

void CoreTlm::end(EndReason reason) {
  end_reason_ = reason;
  horizon_.give_way();
  if (ended_) return ended_(reason);
  sc_core::sc_stop();
}

bool CoreTlm::skip_known_turns() {
  return !sleep_.ends_on_idle() && debugger_ == nullptr && polling_.skip_known(horizon_.limit());
}

/// After an access: if the program only waits for a device, whole turns of its loop up to the next
/// activity of the kernel take no time of the host.
void CoreTlm::skip_polling() {
  if (sleep_.ends_on_idle() || reset_requested_) return;
  const std::optional<Turn> turn = polling_.measure(horizon_.end_of_run());
  if (horizon_.is_late()) horizon_.synchronise();
  horizon_.catch_up();
  if (turn && !reset_requested_) polling_.skip(*turn);
}

void CoreTlm::set_access_gate(AccessGate* gate) {
  bus_.set_gate(gate);
  polling_.forget_read();
}

void CoreTlm::invalidate(int, sc_dt::uint64 first, sc_dt::uint64 last) {
  bus_.invalidate(first, last);
}

bool CoreTlm::access(tlm::tlm_command command, uint32_t address, unsigned size, uint32_t& value,
                     unsigned& wait_cycles, AccessKind kind) {
  polling_.forget_read();
  const bool may_write_early = polling_.enabled() && !is_watched();
  const BusAccess::Result result =
      bus_.access(command, address, size, value, kind, may_write_early);
  wait_cycles = result.wait_cycles;
  accessed({address, size, value, wait_cycles}, kind == AccessKind::load, result);
  return result.ok;
}

/// What follows from an access, however it was made.
void CoreTlm::accessed(const BusTransfer& transfer, bool is_read, const BusAccess::Result& result) {
  polling_.made(transfer, is_read && result.ok, result.steady, horizon_.limit(),
                horizon_.kernel_runs());
  sleep_.note_access(transfer.address);
  const bool changed = !result.quiet && (result.maps || horizon_.is_late());
  if (polling_.seems_to_poll() || horizon_.is_nearer() || changed || is_watched() || is_called())
    core_.attention();
}

bool CoreTlm::read_at_once(uint32_t address, unsigned size, uint32_t& value,
                           unsigned& wait_cycles) {
  const BusTransfer* const same = polling_.repeats(address, size, horizon_.kernel_runs());
  if (same != nullptr && debugger_ == nullptr && !horizon_.is_late()) {
    value = same->value;
    wait_cycles = same->wait_cycles;
    polling_.repeated(horizon_.limit());
    sleep_.note_access(address);
    if (polling_.seems_to_poll()) core_.attention();
    return true;
  }
  const auto result = bus_.read_directly(address, size, value);
  if (!result) return false;
  wait_cycles = result->wait_cycles;
  accessed({address, size, value, wait_cycles}, true, *result);
  return true;
}

bool CoreTlm::fetch_at_once(uint32_t address, unsigned size, uint32_t& value,
                            unsigned& wait_cycles) {
  const auto result = bus_.fetch_directly(address);
  if (!result) return false;
  polling_.forget_read();
  value = 0;
  wait_cycles = result->wait_cycles;
  accessed({address, size, value, wait_cycles}, false, *result);
  return true;
}

bool CoreTlm::read(uint32_t address, unsigned size, uint32_t& value, unsigned& wait_cycles,
                   AccessKind kind) {
  return (kind == AccessKind::load && read_at_once(address, size, value, wait_cycles)) ||
         (kind == AccessKind::fetch && fetch_at_once(address, size, value, wait_cycles)) ||
         access(tlm::TLM_READ_COMMAND, address, size, value, wait_cycles, kind);
}

bool CoreTlm::write_at_once(uint32_t address, unsigned size, uint32_t value,
                            unsigned& wait_cycles) {
  if (!polling_.enabled() || is_watched()) return false;
  const auto result = bus_.write_directly(address, size, value);
  if (!result) return false;
  wait_cycles = result->wait_cycles;
  accessed({address, size, value, wait_cycles}, false, *result);
  return true;
}

bool CoreTlm::write(uint32_t address, unsigned size, uint32_t value, unsigned& wait_cycles) {
  return write_at_once(address, size, value, wait_cycles) ||
         access(tlm::TLM_WRITE_COMMAND, address, size, value, wait_cycles, AccessKind::store);
}

}  // namespace capsoc::armv7m
