// A description made into runs, each with the key under which a store has it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "campaign/description.h"
#include "campaign/design.h"
#include "campaign/work.h"

namespace capsoc::campaign {

/// What a run is done by.
struct Program {
  std::string version;  ///< "0.1.0 (commit 0123456789ab)"
  std::string hash;     ///< SHA-256 of its file

  /// This program.
  static Result<Program> own();
};

/// Small and without memory on the heap: a worker is a fork of this process, and pays for each page
/// that it has.
struct PlannedRun {
  uint64_t number = 0;  ///< in the design
  std::array<char, 64> digits{};

  /// SHA-256 of program, kind, settings and input files, hexadecimal.
  std::string_view key() const { return {digits.data(), digits.size()}; }
};

/// Share `part` of `whole` of all runs, by key: 1 of 1 are all.
struct Shard {
  uint64_t part = 1, whole = 1;
  bool has(std::string_view key) const;
};

class Plan {
 public:
  /// Every run is prepared, and some are checked with their files. Error: what is wrong in the
  /// description, with file and line.
  static Result<Plan> make(Description description, Program program);

  const Description& description() const { return *description_; }
  const Program& program() const { return program_; }
  Work& work() const { return *work_; }
  /// Each once, in the order of the design.
  const std::vector<PlannedRun>& runs() const { return runs_; }
  /// Runs of the design that are the same as an earlier one.
  uint64_t duplicates() const { return duplicates_; }
  /// Of the axes, in the order of Description::axis_paths().
  std::vector<std::string> values(const PlannedRun& run) const {
    return design_->values(run.number);
  }
  /// All that the description sets for a run, axes and what follows from them included. Error: a
  /// derived setting has no value.
  Result<std::vector<Assignment>> assignments(const PlannedRun& run) const;
  Result<std::string> command(const PlannedRun& run) const;
  /// What a run leaves in addition to its result, as [keep] says.
  Keep keep(const PlannedRun& run, bool failed) const;
  /// The session of a failed run; the description has to ask for it.
  Keep keep_session(const PlannedRun& run) const;

 private:
  Plan() = default;
  std::optional<Error> check_names() const;
  std::optional<Error> add_runs();
  std::optional<Error> check_some() const;

  std::unique_ptr<Description> description_;
  std::unique_ptr<Design> design_;
  Program program_;
  std::unique_ptr<Work> work_;
  std::vector<PlannedRun> runs_;
  uint64_t duplicates_ = 0;
};

/// A setting's text as an expression has it: a number, true or false, or a text.
Value value_of(const std::string& text);

}  // namespace capsoc::campaign
