// Which lines, functions and branches of a program were executed.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "armv7m/execution_counts.h"
#include "base/result.h"
#include "soc/soc.h"
#include "source/call_stack.h"
#include "trace/coverage_file.h"

namespace capsoc::trace {

/// Counts from now on to finish(). Changes the simulation's speed and nothing else.
///
/// A line was executed as often as its most often executed instruction; where it has code in
/// several functions (inlined ones), their sum. A decision is a conditional branch, or what an IT
/// block makes of a condition; its line is that of the instruction.
class Coverage {
 public:
  /// A file that is there already is added to. An Error: it is of another program or no such file,
  /// it cannot be written, or the program has no lines, or none of a source that is here. Both must
  /// outlive it.
  static Result<std::unique_ptr<Coverage>> attach(soc::Soc& soc, const source::Program& program,
                                                  const std::string& path);
  ~Coverage();
  Coverage(const Coverage&) = delete;
  Coverage& operator=(const Coverage&) = delete;

  /// Writes the file, whole or not at all; sources that are not on this machine are left out.
  /// After the simulation.
  std::optional<Error> finish();

 private:
  Coverage(soc::Soc& soc, const source::Program& program, std::string path)
      : soc_(soc), program_(program), path_(std::move(path)) {}
  std::optional<Error> read_earlier();
  ProgramCoverage collect() const;

  soc::Soc& soc_;
  const source::Program& program_;
  std::string path_;
  ProgramCoverage earlier_;  ///< what the file has already
  armv7m::ExecutionCounts counts_;
};

}  // namespace capsoc::trace
