// The interface of all observers of a run, and their list.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/result.h"
#include "explain/fault_report.h"
#include "results/results.h"

namespace capsoc::run {

/// Observes a run from before its first instruction to its result, and changes nothing in the
/// simulation. Its constructor takes its settings and the objects that it observes; all of them
/// must outlive it. Calls come in the order of this declaration.
class RunObserver {
 public:
  RunObserver() = default;
  virtual ~RunObserver() = default;
  RunObserver(const RunObserver&) = delete;
  RunObserver& operator=(const RunObserver&) = delete;

  /// Attaches to what it observes. An Error: a wrong setting, or an output that cannot be opened;
  /// nothing is left behind.
  virtual std::optional<Error> open() { return std::nullopt; }

  /// Saves or loads the state for a checkpoint. Names are unique among all observers. An observer
  /// without state visits nothing, so that a restored run may have other observers.
  virtual void visit(Archive&) {}

  /// Name, unique among all observers, of data gathered on the host; null: none. Only a state in
  /// memory has this data, for a simulation that continues with the same settings. A simulation
  /// restored from a file begins without it.
  virtual const char* gathered() const { return nullptr; }
  virtual void visit_gathered(Archive&) {}

  /// A state was restored and the simulation stands there, between two instructions.
  virtual void restored() {}

  /// The simulation is over and its exit code not known yet: completes the outputs, with a sentence
  /// in `result.lost` for each that is not whole.
  virtual void close(RunResult&) {}

  /// After close() of all observers, with the exit code: adds what was observed. May turn a pass
  /// into a failure.
  virtual void finish(RunResult&) {}

  /// Why it stopped the simulation (the reason for exit code `crashed`); empty if it did not.
  virtual std::string crash() const { return ""; }
  /// Its part of a failure report.
  virtual std::optional<Finding> finding() const { return std::nullopt; }
};

/// The observers of a run in the order in which they are opened, closed and finished.
class Observers {
 public:
  /// Opens the observer and keeps it. An Error as RunObserver::open() has it.
  std::optional<Error> add(std::unique_ptr<RunObserver> observer);

  void visit(Archive& archive);
  void restored();
  /// Those that have gathered something.
  std::vector<RunObserver*> gatherers() const;
  void close(RunResult& result);
  void finish(RunResult& result);
  /// Of the first one that stopped the simulation; empty if none did.
  std::string crash() const;
  Findings findings() const;

 private:
  std::vector<std::unique_ptr<RunObserver>> all_;
};

}  // namespace capsoc::run
