#pragma once

#include <optional>
#include <systemc>
#include <utility>

#include "armv7m/core.h"
#include "armv7m/tlm/end_on_idle.h"
#include "armv7m/tlm/end_reason.h"
#include "armv7m/tlm/time_horizon.h"
#include "base/archive.h"
#include "kit/clock_domain.h"

namespace capsoc::armv7m {

/// Sleep of the processor (WFI, WFE): waits in the kernel until an interrupt, an internal event of
/// the core (SysTick) or a client wakes it. Detects a program that has nothing left to do. Nothing
/// passed in is owned.
class Sleep {
 public:
  /// A client that may end a sleep, or run during it. All calls come from the processor's process.
  class Client {
   public:
    virtual bool must_wake() const = 0;
    /// True ends the simulation. Called at each awakening.
    virtual bool is_interrupted() = 0;
    virtual void pause_if_due() = 0;
    virtual bool has_debugger() const = 0;
    /// True: debugger_wants_attention() is polled during the sleep, so that it can interrupt it.
    virtual bool debugger_looks() const = 0;
    virtual bool debugger_wants_attention() const = 0;
    /// Called when nothing is left that could wake the processor. True: the sleep ends, instead of
    /// the simulation.
    virtual bool debugger_takes_over() = 0;

   protected:
    ~Client() = default;
  };

  Sleep(kit::ClockDomain& clock, Core& core, TimeHorizon& horizon, Client& client)
      : clock_(clock), core_(core), horizon_(horizon), client_(client) {}

  /// Sleeps. Anything but `none` ends the simulation. A sleep that nothing in the kernel or in the
  /// core can end continues: sc_start() returns, unless the kernel waits for a host channel
  /// (sc_prim_channel::async_attach_suspending).
  EndReason until_woken();
  /// Nothing in the kernel or in the core can end the present sleep.
  bool is_without_end() const { return only_woken_ && !sc_core::sc_pending_activity(); }
  /// Checks again for a reason to wake up. Call from any process, at any time.
  void wake() { wake_.notify(sc_core::SC_ZERO_TIME); }

  /// Ends the simulation when the program has been idle for a time.
  void set_end_on_idle(EndOnIdle rule) { end_on_idle_.emplace(std::move(rule)); }
  /// The host may wake the processor from outside the simulation. While a pause is planned, the
  /// processor stays asleep even if nothing inside can wake it.
  void expect_inputs() { expects_inputs_ = true; }
  bool ends_on_idle() const { return end_on_idle_.has_value(); }
  /// The program did something at the core's time that is seen outside: it is not idle.
  void note_work();
  /// An access to this address outside the memories.
  void note_access(uint32_t address) {
    if (end_on_idle_ && end_on_idle_->is_work(address)) note_work();
  }
  /// Saves or loads. The state of a run with end_on_idle does not fit a run without, and vice
  /// versa.
  void visit(Archive& archive);

 private:
  EndReason sleep();
  bool wait_for_something(const sc_core::sc_time& now);

  kit::ClockDomain& clock_;
  Core& core_;
  TimeHorizon& horizon_;
  Client& client_;
  sc_core::sc_event wake_;
  std::optional<EndOnIdle> end_on_idle_;
  bool expects_inputs_ = false;
  bool only_woken_ = false;  // waits for wake() and for no time
};

}  // namespace capsoc::armv7m
