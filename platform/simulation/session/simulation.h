// One run of the SoC, controlled by its caller: constructed, advanced in simulated time, saved,
// finished.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backend/coprocessor_backend.h"
#include "base/result.h"
#include "explain/program_view.h"
#include "inject/injector.h"
#include "inject/places.h"
#include "inputs/run_inputs.h"
#include "ports/host_ports.h"
#include "results/results.h"
#include "session/checkpoints.h"
#include "session/host_limit.h"
#include "session/real_time.h"
#include "session/run_limits.h"
#include "session/run_watch.h"
#include "soc/soc.h"

namespace capsoc::run {

class RunSettings;

/// The platform with its program, its sensor and all observers. One instance a process: SystemC's
/// kernel cannot be started twice. Splitting a run into advances, or saving it between them, does
/// not change it.
class Simulation {
 public:
  /// Constructs everything that the settings ask for, in the state that they name
  /// (checkpoint.restore) or in reset. The settings must outlive it. An Error is a wrong input:
  /// nothing was simulated and nothing written.
  static Result<std::unique_ptr<Simulation>> construct(const RunSettings& settings);
  /// Additions of a session to the settings.
  struct Additions {
    std::function<void(RunInputs& inputs)> inputs;  ///< changes them after they were read
    std::string state;  ///< of packed_state(), to continue from instead of reset; "": none
    serial::KeptStreams* kept = nullptr;  ///< for the ITM and the console of semihosting instead of
                                          ///< standard streams; it must outlive the simulation
    bool waits = false;  ///< for set_state() and begin(); before these it has no timer
  };
  static Result<std::unique_ptr<Simulation>> construct(const RunSettings& settings,
                                                       const Additions& additions);
  /// Of one that waits: the state to begin with, as in Additions; the last one counts. An Error as
  /// construct() has it.
  std::optional<Error> set_state(const std::string& state);
  /// Then, perhaps in a fork of the process that constructed it, what is left of the construction.
  /// That the state does not fit is an Error of advance_to().
  std::optional<Error> begin();
  ~Simulation() = default;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Simulates to the first instant at or after `time` at which the processor is between two
  /// instructions; asleep counts as between. False: the run is over, by itself or by a limit. An
  /// Error: the state to continue from did not fit after all.
  Result<bool> advance_to(const sc_core::sc_time& time);
  /// From within the simulation (a probe's listener, a debugger): the advance under way ends at the
  /// first instant from now on at which the processor is between two instructions.
  void stop_soon();
  /// The same from a signal handler, soon. The instant is not deterministic.
  void interrupt();
  /// True if interrupt() was called since the last call of this function.
  bool take_interruption();
  /// True if it cannot continue: the run ended by itself, or at a limit.
  bool is_over() const;
  /// The session may wake the processor: one that nothing inside can wake sleeps until the end of
  /// the advance, instead of ending the run.
  void expect_inputs() { soc_.cpu.expect_inputs(); }
  /// Simulates to the end of the run, whatever ends it.
  std::optional<Error> advance_to_end();

  /// Saves the present state, between two advances, to a file that the settings do not name. An
  /// Error: a file of the run, or one that cannot be written. No partial file is left.
  std::optional<Error> save(const std::string& file);

  /// The same in memory, for additions to the same settings.
  Result<std::string> packed_state(bool with_gathered = false);
  /// Hash (FNV-1a) of the chip's state without state on the host, between two advances. Empty: a
  /// part has an operation under way.
  std::optional<uint64_t> state_hash();

  /// Closes all outputs and returns the result. The last call: nothing can be simulated after it.
  RunResult finish();

  /// To be read between two advances.
  soc::Soc& soc() { return soc_; }
  const ProgramView& view() const { return view_; }
  Observation& observation() { return watch_.observation(); }
  HostPorts& ports() { return *ports_; }
  /// What a fault can change in this system.
  std::vector<inject::ListedPlace> fault_places();
  /// Injects one more fault, between two advances. It begins at its time, now at the earliest; a
  /// fault for now has acted on return. No state can be saved until it is over. An Error is the end
  /// of a sentence: no such place, or a time in the past.
  std::optional<Error> inject(inject::Fault fault);
  /// Outcomes of these faults, in order, including those before the state that this run continues
  /// from.
  std::vector<FaultOutcome> injected() const;
  /// Every fault has acted, and none acts any more.
  bool faults_are_over() const { return injector_ == nullptr || injector_->is_over(); }

 private:
  Simulation(const RunSettings& settings, RunInputs inputs,
             std::optional<checkpoint::Checkpoint> restore, CoprocessorBackend backend,
             serial::KeptStreams* kept);

  std::optional<Error> load();
  std::optional<Error> watch_host();
  std::optional<Error> open(bool waits);
  std::vector<checkpoint::Part> parts();
  std::optional<Error> plan_faults();
  std::vector<checkpoint::Part> gathered();
  sc_core::sc_time next_pause() const;
  std::optional<Error> plan_restore(bool is_tried);
  bool restore();
  bool interrupted();
  void call_from_signal();
  void simulate();
  void simulate_slice();
  void pace();
  sc_core::sc_time pause(const sc_core::sc_time& now);
  void conclude_run(RunResult& result) const;
  void take_figures(RunResult& result) const;
  void explain(RunResult& result) const;

  const RunSettings& settings_;
  RunInputs inputs_;
  std::optional<checkpoint::Checkpoint> restore_;
  std::optional<Error> not_restored_;
  CoprocessorBackend backend_;  // its device is the SoC's
  serial::KeptStreams* kept_;   // null: standard streams
  soc::Soc soc_;
  ProgramView view_;
  Limit limit_;
  HostLimit host_limit_;
  RealTime real_time_;
  std::unique_ptr<HostPorts> ports_;
  std::unique_ptr<inject::Injector> injector_;  // null without faults
  std::vector<FaultOutcome> past_faults_;       // injected before the state that was restored
  RunWatch watch_;
  std::unique_ptr<Checkpoints> checkpoints_;
  sc_core::sc_time stop_at_ = sc_core::sc_max_time();
  bool stopped_ = false;
  std::atomic<bool> called_{false}, stop_asked_{false};
  bool interruption_ = false;
};

/// From settings to the result in one call; an Error as Simulation has it.
Result<RunResult> run(const RunSettings& settings);

}  // namespace capsoc::run
