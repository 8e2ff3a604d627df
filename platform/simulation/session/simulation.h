// One run of the SoC in the hands of its host: built, moved on in simulated time, saved, finished.
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

/// The platform with its program, its sensor, and everything that observes it. One of them a
/// process: SystemC's kernel cannot be started twice. Where a run is cut into pieces, and whether
/// it is saved between them, changes nothing in it.
class Simulation {
 public:
  /// Everything that the settings ask for, in the state that they name (checkpoint.restore) or in
  /// reset. The settings must outlive it. An Error is a wrong input: nothing was simulated and
  /// nothing written.
  static Result<std::unique_ptr<Simulation>> construct(const RunSettings& settings);
  /// What a session adds to the settings.
  struct Additions {
    std::function<void(RunInputs& inputs)>
        inputs;         ///< lays something over them, once they are read
    std::string state;  ///< of packed_state(), to continue from instead of reset; "": none
    serial::KeptStreams* kept = nullptr;  ///< for the ITM and the console of semihosting instead of
                                          ///< standard streams; it must outlive the simulation
  };
  static Result<std::unique_ptr<Simulation>> construct(const RunSettings& settings,
                                                       const Additions& additions);
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
  /// The same from a signal handler, soon; when that is, the host decides.
  void interrupt();
  /// Whether that was, since this was asked last.
  bool take_interruption();
  /// It cannot continue: the run ended by itself, or a limit ended it.
  bool is_over() const;
  /// A processor that nothing inside could wake sleeps on to the end of an advance, since a session
  /// may.
  void expect_inputs() { soc_.cpu.expect_inputs(); }
  /// To the end of the run, whatever ends it.
  std::optional<Error> advance_to_end();

  /// The state as it is now, between two advances, to a file that the settings do not name. An
  /// Error: a file of the run, or one that cannot be written; nothing is half written.
  std::optional<Error> save(const std::string& file);

  /// The same in memory, for additions to the same settings.
  Result<std::string> packed_state(bool with_gathered = false);
  /// Of the chip's state, between two advances, without what is on the host (FNV-1a). Nothing: a
  /// part is in the middle of something.
  std::optional<uint64_t> state_hash();

  /// Closes what was open and says what came of it. Nothing can be simulated after it.
  RunResult finish();

  /// To be looked at between two advances.
  soc::Soc& soc() { return soc_; }
  const ProgramView& view() const { return view_; }
  Observation& observation() { return watch_.observation(); }
  HostPorts& ports() { return *ports_; }
  /// What a fault can change in this system.
  std::vector<inject::ListedPlace> fault_places();
  /// Between two advances: injects one more fault, beginning at its time, now at the earliest.
  /// What can happen now has happened then. No state can be saved until it is over. An Error is the
  /// end of a sentence: no such place, or a time that is past.
  std::optional<Error> inject(inject::Fault fault);
  /// What came of these, in their order; those before a state that this one continues from, too.
  std::vector<FaultOutcome> injected() const;
  /// Every fault has acted, and none acts any more.
  bool faults_are_over() const { return injector_ == nullptr || injector_->is_over(); }

 private:
  Simulation(const RunSettings& settings, RunInputs inputs,
             std::optional<checkpoint::Checkpoint> restore, CoprocessorBackend backend,
             serial::KeptStreams* kept);

  std::optional<Error> load();
  std::optional<Error> open();
  std::vector<checkpoint::Part> parts();
  std::optional<Error> plan_faults();
  std::vector<checkpoint::Part> gathered();
  sc_core::sc_time next_pause() const;
  std::optional<Error> plan_restore();
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
