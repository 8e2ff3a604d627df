#include "cortex_m3_tlm/cortex_m3_tlm.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "kit/guest_error.h"

namespace capsoc::cortex_m3 {
namespace {

/// sc_stop() was called, by whomever.
bool is_stopping() {
  return sc_core::sc_get_simulator_status() != sc_core::SC_SIM_OK;
}

constexpr uint64_t never = std::numeric_limits<uint64_t>::max();
/// What the core executes at once, however long the quantum is: a tenth of a second of the host
/// where every instruction is traced.
constexpr uint64_t longest_run = 1U << 16U;
/// Cycles after which a program that never needs the kernel (it reads devices that have no events)
/// gives way to it: 10 ms at the board's 25 MHz.
constexpr uint64_t longest_ahead = 1U << 18U;
constexpr uint32_t code_region_end =
    0x20000000;  // ARMv7-M B3.1: the Code region is served by I-code and D-code

void log_unpredictable(Unpredictable which, uint32_t address) {
  const UnpredictableCase& c = describe(which);
  // One source a case: each is told of once, so that none is left out.
  const std::string source = fmt::format("cpu: {}", c.name);
  const std::string text = fmt::format("UNPREDICTABLE (ARM DDI 0403, {}) at {:#010x}: {}; here: {}",
                                       c.section, address, c.what, c.choice);
  // Schedulers begin their tasks so: they stack a function's address as C has it.
  if (which == Unpredictable::return_address) return kit::guest_note(source, text);
  kit::guest_error(source, text);
}

}  // namespace

CortexM3Tlm::CortexM3Tlm(const sc_core::sc_module_name& name, kit::ClockDomain& clock)
    : sc_module(name),
      icode("icode"),
      dcode("dcode"),
      system("system"),
      clock_(clock),
      core_(*this) {
  icode.register_invalidate_direct_mem_ptr(this, &CortexM3Tlm::invalidate, 0);
  dcode.register_invalidate_direct_mem_ptr(this, &CortexM3Tlm::invalidate, 1);
  system.register_invalidate_direct_mem_ptr(this, &CortexM3Tlm::invalidate, 2);
  // SysTick's reference clock is 1 MHz whatever HCLK does (AN385).
  clock_.on_change([this] {
    core_.set_systick_reference(static_cast<unsigned>(clock_.frequency_hz() / 1'000'000));
    set_bounds();
    core_.attention();  // the horizon is another cycle now
  });
  core_.listeners().unpredictable = log_unpredictable;
  // Putting them on and off costs as much as a hop of the bus.
  payload_.set_extension(&steady_);
  payload_.set_extension(&early_);
  SC_HAS_PROCESS(CortexM3Tlm);
  SC_THREAD(thread);
}

CortexM3Tlm::~CortexM3Tlm() {
  payload_.clear_extension<kit::SteadyRead>();
  payload_.clear_extension<kit::EarlyWrite>();
}

void CortexM3Tlm::set_interrupt(unsigned line, bool level) {
  core_.set_interrupt(line, level);
  wake_.notify(sc_core::SC_ZERO_TIME);
}

void CortexM3Tlm::pulse_nmi() {
  core_.pulse_nmi();
  wake_.notify(sc_core::SC_ZERO_TIME);
}

void CortexM3Tlm::request_reset() {
  reset_requested_ = true;
  core_.attention();
  wake_.notify(sc_core::SC_ZERO_TIME);
}

void CortexM3Tlm::note_work() {
  // The core may be ahead of the kernel; behind it is only after a change to a faster clock.
  if (end_on_idle_)
    end_on_idle_->begin(std::max(clock_.time_of(core_.cycles()), sc_core::sc_time_stamp()));
}

void CortexM3Tlm::reset_system() {
  reset_requested_ = false;
  latest_holds_ = false;
  note_work();
  if (reset_request_) reset_request_();
  core_.reset();
}

void CortexM3Tlm::set_pause(const sc_core::sc_time& first, Pause pause) {
  pause_at_ = first;
  pause_ = std::move(pause);
  set_bounds();
}

void CortexM3Tlm::resume_at(const sc_core::sc_time& time, std::function<bool()> load) {
  resume_at_ = time;
  load_ = std::move(load);
}

void CortexM3Tlm::visit(kit::Archive& archive) {
  archive("core", core_);
  archive("reset_requested", reset_requested_);
  archive.sequence("granted", granted_, 4096);
  bool watched = end_on_idle_.has_value();
  archive("ends_on_idle", watched);
  if (watched != end_on_idle_.has_value())
    return archive.refuse("is of a run with another end_on_idle");
  if (end_on_idle_) archive("end_on_idle", *end_on_idle_);
}

void CortexM3Tlm::restored() {
  for (const Granted& granted : granted_) map_if_memory(granted.address, granted.kind);
  core_.memory_changed();
}

/// Out of reset, or out of saved state.
bool CortexM3Tlm::begin() {
  if (!load_) {
    core_.reset();
    return true;
  }
  if (resume_at_ > sc_core::sc_time_stamp()) wait(resume_at_ - sc_core::sc_time_stamp());
  const std::function<bool()> load = std::exchange(load_, nullptr);
  return load();
}

void CortexM3Tlm::pause_if_due() {
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  while (pause_ && pause_at_ <= now) {
    pause_at_ = sc_core::sc_max_time();
    latest_holds_ = false;
    pause_at_ = std::max(pause_(now), now + sc_core::sc_time::from_value(1));
  }
}

void CortexM3Tlm::thread() {
  if (!begin()) return end(EndReason::interrupted);
  bool stays = false;  // the kernel has not gone on, and nobody else has done anything
  for (;;) {
    if (stays && (core_.cycles() - asked_at_ >= longest_ahead || is_called())) {
      synchronise();
      catch_up();
      stays = false;
    }
    if (!stays) {
      settle();
      if (sc_core::sc_get_status() == sc_core::SC_STOPPED) return;
      if (is_interrupted()) return end(EndReason::interrupted);
      pause_if_due();
      if (reset_requested_) reset_system();
    }
    bool one = false;
    if (debugger_ != nullptr) {
      one = debugger_->before_run();
      if (debugger_->ended()) return end(EndReason::debugger);
      settle();  // what it wrote to a device
    }
    const uint64_t cycles = core_.cycles(), instructions = core_.instructions();
    if (!std::exchange(stays, false)) look_ahead();
    horizon_ = std::min(limit_, core_.cycles() + longest_run);
    if (core_.cycles() >= horizon_) {
      synchronise();
      catch_up();
      continue;
    }
    const StopReason reason = one ? core_.step_instruction() : core_.run(horizon_);
    const bool advanced = core_.cycles() != cycles || core_.instructions() != instructions;
    // The kernel may stay where it is until something happens in it.
    const bool may_stay = (reason == StopReason::attention || reason == StopReason::budget) &&
                          !reset_requested_ && debugger_ == nullptr;
    stays = may_stay && !is_late();
    if (may_stay)
      let_kernel_follow();
    else
      synchronise();
    catch_up();
    if (std::exchange(seems_to_poll_, false) && reason == StopReason::attention &&
        !(stays && skip_known_turns())) {
      skip_polling();
      stays = false;
    }
    if (debugger_ != nullptr && debugger_->after_run(reason, advanced)) continue;
    switch (reason) {
      case StopReason::sleeping:
        sleep();
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
      case StopReason::budget:
      case StopReason::attention:
      case StopReason::breakpoint:
      case StopReason::watchpoint:
        break;
    }
    if (end_reason_ != EndReason::none) return;
  }
}

bool CortexM3Tlm::is_interrupted() {
  called_.store(false, std::memory_order_relaxed);
  asked_at_ = core_.cycles();
  return interrupted_ && interrupted_();
}

void CortexM3Tlm::end(EndReason reason) {
  end_reason_ = reason;
  sc_core::sc_stop();
}

void CortexM3Tlm::sleep() {
  latest_holds_ = false;
  if (end_on_idle_) end_on_idle_->fall_asleep(sc_core::sc_time_stamp());
  sleep_until_woken();
  if (end_on_idle_) end_on_idle_->wake_up(sc_core::sc_time_stamp());
}

/// Sleeps until an interrupt or an event of the core's own (SysTick) can wake it.
void CortexM3Tlm::sleep_until_woken() {
  // With a debugger it is looked into now and then, so that it can be interrupted.
  const sc_core::sc_time longest_nap(1, sc_core::SC_MS);
  while (!core_.wake_pending() && !reset_requested_) {
    const sc_core::sc_time now = sc_core::sc_time_stamp();
    if (end_on_idle_ && end_on_idle_->is_over(now)) return end(EndReason::end_on_idle);
    sc_core::sc_time nap =
        end_on_idle_ ? end_on_idle_->deadline() - now : sc_core::sc_max_time() - now;
    if (pause_at_ > now && pause_at_ != sc_core::sc_max_time())
      nap = std::min(nap, pause_at_ - now);
    const uint64_t internal = core_.next_internal_event();
    if (internal != never) {
      const sc_core::sc_time until = clock_.time_of(internal);
      if (debugger_ != nullptr) nap = std::min(nap, longest_nap);
      if (until > now) wait(std::min(until - now, nap), wake_);
    } else if (debugger_ != nullptr && sc_core::sc_pending_activity()) {
      wait(std::min(nap, longest_nap), wake_);
    } else {
      // Nothing in the kernel and nothing in the core: this sleep has no end.
      if (debugger_ != nullptr && debugger_->asleep_for_good()) return;
      if (!end_on_idle_ && !sc_core::sc_pending_activity()) return end(EndReason::asleep);
      if (end_on_idle_ || pause_at_ != sc_core::sc_max_time())
        wait(nap, wake_);
      else
        wait(wake_);
    }
    settle();
    catch_up();
    if (is_interrupted()) return end(EndReason::interrupted);
    if (end_on_idle_ && pause_at_ <= sc_core::sc_time_stamp()) {
      end_on_idle_->wake_up(sc_core::sc_time_stamp());  // what was slept so far counts
    }
    pause_if_due();
    if (debugger_ != nullptr && debugger_->wants_attention()) return;
  }
}

/// Everything else that happens at this instant happens before the processor's next instruction. If
/// that is the end there is none: sc_stop() lets the processes of its delta cycle run.
void CortexM3Tlm::settle() {
  while (sc_core::sc_pending_activity_at_current_time() || is_stopping())
    let_kernel_run(sc_core::SC_ZERO_TIME);
}

void CortexM3Tlm::let_kernel_run(const sc_core::sc_time& time) {
  latest_holds_ = false;
  wait(time);
}

/// Behind a read that the kernel has not gone on since: if it is the one of the turn measured last,
/// and everything else is as it was there, that turn need not be measured again.
bool CortexM3Tlm::skip_known_turns() {
  if (end_on_idle_ || !steady_.steady || !(latest_ == read_of_turn_)) return false;
  const std::optional<Turn> turn = core_.known_turn();
  if (!turn) return false;
  polling_.looked(true);
  core_.skip_turns(*turn, limit_);
  return true;
}

/// Behind an access: if the program only waits for a device, whole turns of its loop up to the next
/// activity of the kernel take no time of the host.
void CortexM3Tlm::skip_polling() {
  if (end_on_idle_ || reset_requested_) return;
  steady_until_ = Core::never;
  read_at_ = {};
  measuring_ = true;
  const std::optional<Turn> turn = core_.repeat_turn(horizon_);
  measuring_ = false;
  const bool polls = turn && steady_until_ > core_.cycles();
  const bool reads_once = polls &&
                          std::min(read_at_[0], read_at_[1]) < core_.cycles() - turn->cycles &&
                          std::max(read_at_[0], read_at_[1]) >= core_.cycles() - turn->cycles;
  read_of_turn_ = reads_once ? latest_ : std::nullopt;
  if (polls || core_.cycles() < horizon_) polling_.looked(polls);
  if (is_late()) synchronise();
  catch_up();
  if (turn && !reset_requested_) core_.skip_turns(*turn, steady_until_);
}

/// Something happens in the kernel, or between it and the core, at or before the core's time; or
/// the kernel is to stop and waits for its processes.
bool CortexM3Tlm::is_late() const {
  return core_.cycles() >= late_from_ || is_stopping();
}

void CortexM3Tlm::look_ahead() {
  looked_at_ = sc_core::sc_time_stamp();
  next_activity_ = looked_at_ + sc_core::sc_time_to_pending_activity();
  set_bounds();
}

/// What follows from the times, in cycles, which is what is compared at every access: the next
/// activity, a pause or the quantum's end.
void CortexM3Tlm::set_bounds() {
  const sc_core::sc_time& first = std::min(next_activity_, pause_at_);
  late_from_ = first <= looked_at_ ? 0 : clock_.next_edge(first);
  limit_ = clock_.cycles_at(std::min(looked_at_ + quantum_, next_activity_));
  if (pause_at_ <= next_activity_) limit_ = std::min(limit_, clock_.next_edge(pause_at_));
  limit_ = std::max(limit_, clock_.cycles_at(looked_at_) + 1);
}

/// Lets the kernel catch up with the core.
void CortexM3Tlm::synchronise() {
  const sc_core::sc_time local = clock_.time_of(core_.cycles());
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  if (local > now) let_kernel_run(local - now);
  settle();
}

/// Lets the kernel do what it has to do up to the core's time, but go no further: the core comes
/// at the same instant as what it waits for, which spares the kernel an instant of its own.
void CortexM3Tlm::let_kernel_follow() {
  while (is_late()) {
    const sc_core::sc_time now = sc_core::sc_time_stamp();
    if (is_stopping() || pause_at_ <= next_activity_) return synchronise();
    if (next_activity_ > now) let_kernel_run(next_activity_ - now);
    settle();
    look_ahead();
  }
}

/// After a change to a faster clock inside an instruction the domain is ahead of the core: the core
/// stalls.
void CortexM3Tlm::catch_up() {
  const uint64_t cycle = clock_.cycles_at(sc_core::sc_time_stamp());
  if (cycle > core_.cycles()) core_.skip_to(cycle);
}

CortexM3Tlm::Socket& CortexM3Tlm::port(uint32_t address, AccessKind kind) {
  if (address >= code_region_end) return system;
  return kind == AccessKind::fetch ? icode : dcode;
}

bool CortexM3Tlm::map_if_memory(uint32_t address, AccessKind kind) {
  Socket& socket = port(address, kind);
  tlm::tlm_generic_payload request;
  tlm::tlm_dmi memory;
  request.set_address(address);
  request.set_command(tlm::TLM_WRITE_COMMAND);
  if (!socket->get_direct_mem_ptr(request, memory)) return false;
  const uint64_t size = memory.get_end_address() - memory.get_start_address() + 1;
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  const auto wait_states = static_cast<unsigned>(clock_.cycles_at(now + memory.get_read_latency()) -
                                                 clock_.cycles_at(now));
  core_.map_memory(static_cast<uint32_t>(memory.get_start_address()), static_cast<uint32_t>(size),
                   memory.get_dmi_ptr(), memory.is_write_allowed(), wait_states);
  return true;
}

void CortexM3Tlm::invalidate(int, sc_dt::uint64 first, sc_dt::uint64 last) {
  core_.unmap_memory(static_cast<uint32_t>(first), static_cast<uint32_t>(last - first + 1));
  granted_.erase(std::remove_if(granted_.begin(), granted_.end(),
                                [&](const Granted& granted) {
                                  return granted.address >= first && granted.address <= last;
                                }),
                 granted_.end());
}

/// A read that does nothing need not be made at its own time where the device can be told it, nor a
/// write that does nothing else yet.
bool CortexM3Tlm::may_be_ahead(uint32_t address, AccessKind kind) const {
  if (is_late()) return false;
  if (kind == AccessKind::load) return address == steady_address_;
  return kind == AccessKind::store && fast_forward_ && debugger_ == nullptr &&
         address == early_address_ && payload_.get_data_length() == early_size_;
}

/// Makes the transaction that payload_ describes; returns the cycles it took.
unsigned CortexM3Tlm::transport(uint32_t address, AccessKind kind) {
  const bool ahead = may_be_ahead(address, kind);
  if (!ahead) synchronise();
  const unsigned cycles = send(address, kind, ahead);
  if (kind != AccessKind::store || !early_.refused()) return cycles;
  synchronise();
  return send(address, kind, false);
}

unsigned CortexM3Tlm::send(uint32_t address, AccessKind kind, bool ahead) {
  steady_.steady = false;
  payload_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  early_.early = ahead;
  early_.taken = false;
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  const sc_core::sc_time begin =
      ahead ? clock_.time_of(core_.cycles()) - now : sc_core::SC_ZERO_TIME;
  sc_core::sc_time delay = begin;
  accessing_ = kind;
  port(address, kind)->b_transport(payload_, delay);
  accessing_.reset();
  return static_cast<unsigned>(clock_.cycles_at(sc_core::sc_time_stamp() + delay) -
                               clock_.cycles_at(now + begin));
}

bool CortexM3Tlm::access(tlm::tlm_command command, uint32_t address, unsigned size, uint32_t& value,
                         unsigned& wait_cycles, AccessKind kind) {
  uint8_t bytes[4] = {};
  if (command == tlm::TLM_WRITE_COMMAND)
    for (unsigned i = 0; i < size; ++i) bytes[i] = static_cast<uint8_t>(value >> (8 * i));
  payload_.set_command(command);
  payload_.set_address(address);
  payload_.set_dmi_allowed(false);
  payload_.set_data_ptr(bytes);
  payload_.set_data_length(size);
  payload_.set_streaming_width(size);
  latest_holds_ = false;
  wait_cycles = transport(address, kind);
  // A steady read that was made ahead has done nothing.
  if (!early_.early || !steady_.steady) look_ahead();
  const bool ok = payload_.is_response_ok();
  const bool maps = payload_.is_dmi_allowed() && map_if_memory(address, kind);
  if (maps) granted_.push_back({address, kind});

  value = 0;
  for (unsigned i = 0; i < size; ++i) value |= static_cast<uint32_t>(bytes[i]) << (8 * i);
  if (steady_.steady) steady_address_ = address;
  latest_holds_ = fast_forward_ && steady_.steady && ok && kind == AccessKind::load;
  if (kind == AccessKind::store) {
    early_address_ = early_.taken ? std::optional(address) : std::nullopt;
    early_size_ = size;
  }
  latest_ = Transfer{address, size, value, wait_cycles};
  note_access(*latest_, steady_.steady);
  const bool is_nearer = limit_ < horizon_;
  if (seems_to_poll_ || is_nearer || maps || is_late() || debugger_ != nullptr || is_called())
    core_.attention();
  return ok;
}

/// What follows from every access, made or known.
void CortexM3Tlm::note_access(const Transfer& access, bool steady) {
  // What comes behind it may change the status again, and be over when the turn is.
  if (measuring_) {
    steady_until_ = steady ? std::min(steady_until_, limit_) : 0;
    read_at_ = {read_at_[1], core_.cycles()};
  }
  if (end_on_idle_ && end_on_idle_->is_work(access.address)) note_work();
  seems_to_poll_ = fast_forward_ && !measuring_ &&
                   polling_.is_worth_a_look(access.address, access.value, steady);
}

/// The same read again, of which the device said that its answer stays as long as the kernel has
/// nothing to do.
bool CortexM3Tlm::holds(uint32_t address, unsigned size) const {
  return latest_holds_ && latest_->address == address && latest_->size == size &&
         debugger_ == nullptr && !is_late();
}

bool CortexM3Tlm::read(uint32_t address, unsigned size, uint32_t& value, unsigned& wait_cycles,
                       AccessKind kind) {
  if (kind != AccessKind::load || !holds(address, size))
    return access(tlm::TLM_READ_COMMAND, address, size, value, wait_cycles, kind);
  value = latest_->value;
  wait_cycles = latest_->wait_cycles;
  note_access(*latest_, true);
  if (seems_to_poll_) core_.attention();
  return true;
}

bool CortexM3Tlm::write(uint32_t address, unsigned size, uint32_t value, unsigned& wait_cycles) {
  return access(tlm::TLM_WRITE_COMMAND, address, size, value, wait_cycles, AccessKind::store);
}

}  // namespace capsoc::cortex_m3
