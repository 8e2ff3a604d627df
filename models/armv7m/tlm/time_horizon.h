#pragma once

#include <cstdint>
#include <systemc>

#include "armv7m/core.h"
#include "armv7m/tlm/settling_turn.h"
#include "kit/clock_domain.h"

namespace capsoc::armv7m {

/// Lookahead of the core: how far it may run ahead of the kernel, and how the two synchronise. The
/// core never passes the kernel's next pending activity, a pause, or the end of the quantum.
///
/// Functions that wait must be called from the processor's SystemC process. Cycles are edge numbers
/// of the clock. Clock and core are not owned.
class TimeHorizon {
 public:
  TimeHorizon(kit::ClockDomain& clock, Core& core) : clock_(clock), core_(core) {}

  /// How far the core may run ahead, from the next look_ahead() on.
  void set_quantum(const sc_core::sc_time& quantum) {
    quantum_ = quantum;
    has_bounds_ = false;
  }
  /// The core stops at the first instant at or after `time`; sc_max_time(): no pause.
  void set_pause(const sc_core::sc_time& time);
  /// The same, effective from the next look_ahead(). Call between two runs of the core.
  void plan_pause(const sc_core::sc_time& time) {
    pause_at_ = time;
    has_bounds_ = false;
  }
  const sc_core::sc_time& pause_at() const { return pause_at_; }
  bool pauses() const { return pause_at_ != sc_core::sc_max_time(); }

  /// Asks the kernel for its next activity. Call after anything that may have scheduled one.
  void look_ahead();
  /// Recomputes the bounds: the same times may be other cycles now.
  void clock_changed() { set_bounds(); }
  /// Begins a run of the core. Returns the first cycle that it may not reach, at most `longest`
  /// cycles from now.
  uint64_t begin_run(uint64_t longest);
  /// End of the present run, as begin_run() returned it.
  uint64_t end_of_run() const { return end_of_run_; }
  /// True if a bound is nearer than at the beginning of the run.
  bool is_nearer() const { return limit_ < end_of_run_; }
  /// The first cycle that the core may not pass without the kernel.
  uint64_t limit() const { return limit_; }
  /// True if the kernel has activity, or a pause is due, at or before the core's time; or if the
  /// kernel is stopping and waits for its processes.
  bool is_late() const { return core_.cycles() >= late_from_ || is_stopping(); }

  /// Lets the kernel catch up with the core, and settles.
  void synchronise();
  /// Runs all kernel activity that is due up to the core's time, without a wait at the core's own
  /// time. So the core sees what it polls for without an extra instant. If a pause is due, it
  /// synchronises.
  void follow();
  /// Lets everything else at this instant happen before the processor's next instruction. Several
  /// processors in one kernel execute one after the other, each up to its next wait: their
  /// interaction is exact to the quantum.
  void settle();
  /// Call before the processor's process waits other than by this object, or calls a target that
  /// may wait.
  void give_way() { turn_.give_way(); }
  /// Advances the core to the kernel. After a change to a faster clock inside an instruction the
  /// clock domain is ahead of the core: the core stalls.
  void catch_up();
  /// Changes whenever the kernel has run.
  uint64_t kernel_runs() const { return kernel_runs_; }

 private:
  /// sc_stop() was called, by any process.
  static bool is_stopping() { return sc_core::sc_get_simulator_status() != sc_core::SC_SIM_OK; }
  static bool is_unsettled() {
    return sc_core::sc_pending_activity_at_current_time() || is_stopping();
  }
  void set_bounds();
  void let_kernel_run(const sc_core::sc_time& time);

  kit::ClockDomain& clock_;
  Core& core_;
  sc_core::sc_time quantum_{1, sc_core::SC_MS};
  sc_core::sc_time pause_at_ = sc_core::sc_max_time();
  sc_core::sc_time looked_at_;      // time of the last look_ahead(), after an access or a wait
  sc_core::sc_time next_activity_;  // of the kernel then; only a new event moves it nearer
  bool has_bounds_ = false;         // limit_ and late_from_ match these times
  uint64_t late_from_ = 0;          // the first cycle at or after which the kernel has to run
  uint64_t limit_ = 0;
  uint64_t end_of_run_ = 0;
  uint64_t kernel_runs_ = 0;
  SettlingTurn turn_;
};

}  // namespace capsoc::armv7m
