// A regression: every scenario on its own pair of devices, in its own process, as many at once
// as asked for. The result depends on the seeds alone.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "coprocessor/device.h"
#include "coprocessor/types.h"
#include "regress/coverage.h"
#include "regress/scenario.h"

namespace capsoc::regress {

/// A node of both devices around a difference, one value a clock in the unit of its format.
struct Wave {
  std::string node;
  std::vector<double> model, rtl;
};

/// What a run failed by, as a report shows it.
struct Finding {
  enum class Kind {
    difference,  ///< one device is not as the other
    wrong,       ///< both do the same, but it is wrong
    no_result    ///< the run crashed, or was out of time
  };
  Kind kind = Kind::difference;
  uint64_t cycle = 0;            ///< PCLK edge
  std::string what;              ///< "read of 0x0c0 (ANGLE): model 0x1, RTL 0x2"
  std::string node;              ///< that went wrong first; "" if no node did
  std::string report;            ///< several lines
  uint64_t first_cycle = 0;      ///< of the waves
  std::vector<Wave> waves = {};  ///< the node that went wrong first, then others; may be none
};

/// Two devices that are compared while one interface drives both.
class Comparison {
 public:
  /// Drives a device as the compared ones were driven, until `failed` says so.
  using Again = std::function<void(coprocessor::Device& device, std::function<bool()> failed)>;

  virtual ~Comparison() = default;
  /// How it has to be driven.
  virtual Bench::Bus bus() const { return Bench::Bus::fastest; }
  virtual coprocessor::Device& device() = 0;
  virtual bool differs() = 0;
  /// After the last transfer.
  virtual std::optional<Finding> finding() = 0;
  /// Both devices around the difference, as FILE.fst and FILE.gtkw. false: there is nothing to see.
  virtual Result<bool> write_waves(const std::string& /*file*/, const Again& /*again*/) {
    return false;
  }
  /// Coverage of the RTL's lines and signals so far; nothing to do without.
  virtual std::optional<Error> write_coverage(const std::string&) { return std::nullopt; }

 protected:
  Comparison() = default;
  Comparison(const Comparison&) = default;
  Comparison& operator=(const Comparison&) = default;
};

/// What is compared with the model of an arithmetic.
struct Subject {
  coprocessor::Arithmetic arithmetic = coprocessor::Arithmetic::precise;
  std::string hash;  ///< of its sources, in hexadecimal
  std::string seen;  ///< of it: "pins and inside", ...
};

struct Plan {
  std::vector<coprocessor::Arithmetic> arithmetics;
  unsigned tick = coprocessor::tick_cycles;  ///< cycles, of all devices
  uint64_t first_seed = 1, seeds = 1;
  uint64_t samples = 0, accesses = 0;  ///< of each arithmetic, over all random scenarios and seeds
  unsigned jobs = 1;
  double seconds = 0;  ///< that a run may take; 0: as long as should_end_within() says
  std::vector<std::string> scenarios;  ///< names; empty: all
  std::string coverage_directory;      ///< "": no coverage of the RTL
  std::string waves_directory;         ///< of runs that fail; "": none
  std::vector<Subject> subjects;       ///< for the reports; may be none
  std::string command_options;  ///< of the command that reproduces a run, in addition to its own
  std::function<Result<std::unique_ptr<Comparison>>(coprocessor::Arithmetic)> compare;
};

/// One scenario with one seed.
struct Run {
  coprocessor::Arithmetic arithmetic = coprocessor::Arithmetic::precise;
  const Scenario* scenario = nullptr;
  uint64_t seed = 0;
  Budget budget;
  std::string command;        ///< that repeats this run
  std::string coverage_file;  ///< "" without
  std::string waves_file;     ///< where waves of a failure go, without an ending; "": nowhere
  // Results
  bool done = false;
  Bench::Counts counts;
  std::optional<Finding> finding;
  bool has_waves = false;
  double wall_s = 0;
};

struct Outcome {
  std::vector<Run> runs;  ///< by arithmetic, scenario and seed
  std::vector<std::pair<coprocessor::Arithmetic, Coverage>> coverage;

  /// The first failure of the first kind that there is.
  const Run* first_failure() const;
  size_t done() const;
  bool complete() const { return done() == runs.size(); }
};

/// The runs of a plan, without results. Error: a scenario that does not exist.
Result<std::vector<Run>> runs_of(const Plan& plan);

/// Does one run in this process. Error: devices that cannot be made, coverage or waves that cannot
/// be written.
std::optional<Error> perform(const Plan& plan, Run& run, Coverage& coverage);

/// Does all of them, each in a worker process; progress goes to stderr. A signal ends it with what
/// is done until then. `asked` is called when SIGUSR1 asks for a report on the way. Error: as
/// perform() has it.
Result<Outcome> run_campaign(const Plan& plan,
                             const std::function<void(const Outcome&)>& asked = {});

/// Seconds: ten times what a slow host takes for a run with coverage.
double should_end_within(const Budget& budget);

const char* name_of(coprocessor::Arithmetic arithmetic);

}  // namespace capsoc::regress
