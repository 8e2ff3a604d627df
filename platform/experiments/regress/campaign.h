// A regression: every scenario on its own pair of devices, in as many threads as asked for. The
// result depends on the seeds alone.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coprocessor/device.h"
#include "coprocessor/types.h"
#include "regress/coverage.h"
#include "regress/scenario.h"
#include "support/result.h"

namespace capsoc::regress {

/// A node of both devices around a difference, one value a clock in the unit of its format.
struct Wave {
  std::string node;
  std::vector<double> model, rtl;
};

/// A difference, as a report shows it.
struct Finding {
  uint64_t cycle = 0;            ///< PCLK edge
  std::string what;              ///< "read of 0x0c0 (ANGLE): model 0x1, RTL 0x2"
  std::string node;              ///< that went wrong first; "" if no node did
  std::string report;            ///< several lines
  bool of_devices = true;        ///< false: both do the same, but it is wrong
  uint64_t first_cycle = 0;      ///< of the waves
  std::vector<Wave> waves = {};  ///< the node that went wrong first, then others; may be none
};

/// Two devices that are compared while one interface drives both.
class Comparison {
 public:
  virtual ~Comparison() = default;
  virtual coprocessor::Device& device() = 0;
  virtual bool differs() const = 0;
  virtual std::optional<Finding> finding() const = 0;
  /// Coverage of the RTL's lines and signals so far; nothing to do without.
  virtual std::optional<Error> write_coverage(const std::string&) { return std::nullopt; }

 protected:
  Comparison() = default;
  Comparison(const Comparison&) = default;
  Comparison& operator=(const Comparison&) = default;
};

struct Plan {
  std::vector<coprocessor::Arithmetic> arithmetics;
  uint64_t first_seed = 1, seeds = 1;
  uint64_t samples = 0, accesses = 0;  ///< of each arithmetic, over all random scenarios and seeds
  unsigned jobs = 1;
  std::vector<std::string> scenarios;  ///< names; empty: all
  std::string coverage_directory;      ///< "": no coverage of the RTL
  std::string command_options;         ///< of the command that reproduces a run, beside its own
  std::function<Result<std::unique_ptr<Comparison>>(coprocessor::Arithmetic)> compare;
};

/// One scenario with one seed.
struct Run {
  coprocessor::Arithmetic arithmetic = coprocessor::Arithmetic::precise;
  const Scenario* scenario = nullptr;
  uint64_t seed = 0;
  Budget budget;
  // Results
  Bench::Counts counts;
  std::optional<Finding> finding;
  std::string command;        ///< that repeats this run
  std::string coverage_file;  ///< "" without
};

struct Outcome {
  std::vector<Run> runs;  ///< by arithmetic, scenario and seed
  std::vector<std::pair<coprocessor::Arithmetic, Coverage>> coverage;

  /// One of the devices before one of their common result.
  const Run* first_difference() const;
};

/// The runs of a plan, without results. Error: a scenario that does not exist.
Result<std::vector<Run>> runs_of(const Plan& plan);

/// Error: devices that cannot be made or coverage that cannot be written.
Result<Outcome> run_campaign(const Plan& plan);

const char* name_of(coprocessor::Arithmetic arithmetic);

}  // namespace capsoc::regress
