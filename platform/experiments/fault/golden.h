// The run without a fault: states to begin from, and all that a run with one is compared with.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/result.h"
#include "fault/unread.h"
#include "fault/verdict.h"
#include "inject/places.h"
#include "session/run_settings.h"

namespace capsoc::fault {

/// A fault can begin somewhere between two of these.
struct Start {
  uint64_t time_ps = 0;
  uint64_t sample = 0;  ///< number of the newest one that was converted
  void visit(Archive& archive);
};

/// Between two looks at the state.
inline constexpr double step_s = 0.02;

struct Golden {
  std::vector<Start> starts;
  std::vector<SampleResult> results;            ///< since the first start
  std::vector<std::optional<uint64_t>> hashes;  ///< of the state at `from_s` + n step_s
  double from_s = 0, ended_s = 0;
  int code = 0;  ///< the exit code
  std::vector<inject::ListedPlace> places;
  std::vector<Unread> unread;  ///< since the first start
  void visit(Archive& archive);
};

struct Span {
  double from_s, to_s, until_s;
};

/// Performs the run, in this process, which can perform no other one. Leaves the states in
/// `folder`. An Error: an input is wrong, or the run ends before `until_s`.
Result<Golden> record_golden(const run::RunSettings& settings, const Span& span,
                             const std::string& folder);

/// The state of starts[number], as run::Simulation::Additions has it.
Result<std::string> read_state(const std::string& folder, std::size_t number);

/// What record_golden() gave, kept in the folder. Written last: where it is, all is.
std::optional<Error> write_golden(Golden& golden, const std::string& folder);
Result<Golden> read_golden(const std::string& folder);
bool has_golden(const std::string& folder);

}  // namespace capsoc::fault
