// TLM-2.0 wrapper of the Cortex-M3: three AHB-Lite ports, interrupt lines, and the relation of the
// core's cycles to simulated time.
//
// The quantum only affects speed. The core never runs past the kernel's next pending activity.
// Before an access to a device it synchronises, unless the device accepts the time of the access as
// a delay. So every model sees every access at its exact time, and every interrupt reaches the core
// at the instruction it would reach without temporal decoupling.
#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <systemc>

#include "armv7m/core.h"
#include "armv7m/tlm/bus_access.h"
#include "armv7m/tlm/debugger.h"
#include "armv7m/tlm/end_on_idle.h"
#include "armv7m/tlm/end_reason.h"
#include "armv7m/tlm/polling_skipper.h"
#include "armv7m/tlm/sleep.h"
#include "armv7m/tlm/time_horizon.h"
#include "kit/clock_domain.h"
#include "kit/component.h"

namespace capsoc::armv7m {

/// The processor as a bus master: its SystemC process, which uses a TimeHorizon, a BusAccess, a
/// PollingSkipper and a Sleep.
class CoreTlm : public sc_core::sc_module,
                public kit::Component,
                private Bus,
                private Sleep::Client {
 public:
  using Socket = tlm_utils::simple_initiator_socket_tagged<CoreTlm, 32>;

  Socket icode;   ///< instruction fetches below 0x20000000
  Socket dcode;   ///< data accesses below 0x20000000
  Socket system;  ///< everything else

  /// Neither is owned.
  CoreTlm(const sc_core::sc_module_name& name, kit::ClockDomain& clock,
          const Profile& profile = cortex_m3);

  /// How far the core may run ahead of the kernel.
  void set_quantum(const sc_core::sc_time& quantum) { horizon_.set_quantum(quantum); }
  /// Whether iterations of a loop that only polls a device are skipped while nothing can happen.
  /// Other accesses of such loops are then made without the kernel where possible. Changes only the
  /// host's time.
  void set_fast_forward(bool on) { polling_.set_enabled(on); }
  /// Called for SYSRESETREQ and request_reset(), at that time; resets the rest of the system.
  void on_reset_request(std::function<void()> callback) { reset_request_ = std::move(callback); }
  /// Sets the level of an interrupt line. If the gate blocks the change, the line keeps its level.
  void set_interrupt(unsigned line, bool level);
  /// Called before each change of an interrupt line: false blocks it. Unset: none is blocked.
  using InterruptGate = std::function<bool(unsigned line, bool level)>;
  void set_interrupt_gate(InterruptGate gate) { interrupt_gate_ = std::move(gate); }
  /// Asked about each access from here on; null: none is. Set it between two instructions. Not
  /// owned.
  void set_access_gate(AccessGate* gate);
  /// A rising edge of the NMI input.
  void pulse_nmi();
  /// Drops decoded and translated code of a range. Call after another master has written it; for
  /// masters on a bus::AhbMatrix connect its `replaced`.
  void memory_replaced(uint64_t first, uint64_t last) {
    core_.invalidate_code(static_cast<uint32_t>(first), static_cast<uint32_t>(last - first + 1));
  }
  /// A system reset from outside (a watchdog, a pin), before the next instruction.
  void request_reset();

  /// Sets the callback for the end of the processor, called in its process instead of sc_stop().
  /// With several processors in one kernel, the others continue. Unset: the simulation stops.
  void on_end(std::function<void(EndReason)> callback) { ended_ = std::move(callback); }

  Core& core() { return core_; }
  const Core& core() const { return core_; }
  /// `asleep` is no end: the host may still wake the processor, if sc_start() is called again or
  /// the kernel waits for the host (Sleep::until_woken).
  EndReason end_reason() const { return sleep_.is_without_end() ? EndReason::asleep : end_reason_; }

  /// Kind of the access that is on a socket now; empty: it is not the core's (a debugger's).
  std::optional<AccessKind> accessing() const { return bus_.accessing(); }

  /// Sets the callback that ends the simulation by returning true (a limit of host time, a signal).
  /// An executing core calls it at least every few hundred thousand cycles, and soon after
  /// interrupt() in any state.
  void set_interrupted(std::function<bool()> interrupted) { interrupted_ = std::move(interrupted); }
  /// Makes an executing core call that callback soon. Async-signal-safe.
  void interrupt() { called_.store(true, std::memory_order_relaxed); }
  /// The same for a sleeping core, at any simulated time. Called by the owner of the kernel while
  /// the kernel is paused.
  void wake_if_interrupted() {
    if (is_called()) sleep_.wake();
  }

  /// Call after the end of the simulation: counts the cycles of a sleeping core up to now, even if
  /// an event woke it in between.
  void count_sleep() { horizon_.catch_up(); }

  /// Ends the simulation when the program has been idle for the rule's time (end_on_idle.h).
  void set_end_on_idle(EndOnIdle rule) { sleep_.set_end_on_idle(std::move(rule)); }
  /// Call when the program does something visible outside at this instant: it is not idle.
  void note_work() { sleep_.note_work(); }

  /// Called between two instructions (or asleep) at the first instant at or after the requested
  /// time, with the core and the kernel at the same instant. Returns the time of the next call;
  /// sc_max_time(): never. Must not change the simulation.
  using Pause = std::function<sc_core::sc_time(const sc_core::sc_time& now)>;
  void set_pause(const sc_core::sc_time& first, Pause pause);
  /// Requests the pause now, from within a call that the processor makes.
  void pause_now() { horizon_.set_pause(sc_core::SC_ZERO_TIME); }
  /// The same from anywhere in the simulation, whatever the processor does.
  void pause_soon() {
    pause_now();
    sleep_.wake();
  }
  /// The host may wake the processor. A processor that nothing inside can wake then sleeps until
  /// the pause, instead of ending the simulation.
  void expect_inputs() { sleep_.expect_inputs(); }
  /// Replaces the reset at time 0: nothing happens until `time`, when `load` restores the system's
  /// state. If it returns false, the simulation ends.
  void resume_at(const sc_core::sc_time& time, std::function<bool()> load);
  bool waits_for_resume() const { return static_cast<bool>(load_); }

  const char* component_name() const override { return basename(); }
  /// Does nothing: the processor resets its core itself, after the callback of on_reset_request().
  void reset() override {}
  void visit(Archive& archive) override;
  void restored() override;

  /// Asked before and notified after every run of the core. Null: none. Not owned.
  void set_debugger(Debugger* debugger) { debugger_ = debugger; }
  /// Resets the system at once; for the debugger, from within its calls.
  void reset_now() { reset_system(); }

 private:
  void thread();
  bool is_called() const { return called_.load(std::memory_order_relaxed); }
  bool skip_known_turns();
  void skip_polling();
  void end(EndReason reason);
  bool begin();
  void reset_system();
  bool access(tlm::tlm_command command, uint32_t address, unsigned size, uint32_t& value,
              unsigned& wait_cycles, AccessKind kind);
  void invalidate(int port, sc_dt::uint64 first, sc_dt::uint64 last);
  void attend_to(StopReason reason);

  bool read(uint32_t address, unsigned size, uint32_t& value, unsigned& wait_cycles,
            AccessKind kind) override;
  bool write(uint32_t address, unsigned size, uint32_t value, unsigned& wait_cycles) override;
  bool read_at_once(uint32_t address, unsigned size, uint32_t& value,
                    unsigned& wait_cycles) override;
  bool write_at_once(uint32_t address, unsigned size, uint32_t value,
                     unsigned& wait_cycles) override;
  bool fetch_at_once(uint32_t address, unsigned size, uint32_t& value, unsigned& wait_cycles);
  void accessed(const BusTransfer& transfer, bool is_read, const BusAccess::Result& result);

  bool must_wake() const override { return reset_requested_; }
  bool is_interrupted() override;
  void pause_if_due() override;
  bool has_debugger() const override { return debugger_ != nullptr; }
  /// Core and kernel have to be at the same instant between any two runs.
  bool is_watched() const { return debugger_ != nullptr && !debugger_->sees_stops_alone(); }
  bool debugger_looks() const override {
    return debugger_ != nullptr && debugger_->looks_at_sleep();
  }
  bool debugger_wants_attention() const override {
    return debugger_ != nullptr && debugger_->wants_attention();
  }
  bool debugger_takes_over() override { return debugger_->asleep_for_good(); }

  kit::ClockDomain& clock_;
  Core core_;
  TimeHorizon horizon_;
  BusAccess bus_;
  PollingSkipper polling_;
  Sleep sleep_;
  std::atomic<bool> called_{false};  // by interrupt()
  uint64_t asked_at_ = 0;            // the cycle at which interrupted_ was asked last
  std::function<void()> reset_request_;
  InterruptGate interrupt_gate_;
  std::function<bool()> interrupted_;
  std::function<void(EndReason)> ended_;
  EndReason end_reason_ = EndReason::none;
  Debugger* debugger_ = nullptr;
  bool reset_requested_ = false;
  Pause pause_;
  sc_core::sc_time resume_at_;
  std::function<bool()> load_;  // empty: nothing to be loaded, or it is
};

}  // namespace capsoc::armv7m
