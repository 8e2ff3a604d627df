// The traces of a part of a simulation.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "host/file_uses.h"
#include "observers/trace_settings.h"
#include "observers/traces.h"
#include "results/results.h"
#include "service/board.h"

namespace capsoc::service {

/// Which traces there are and where they go: the settings `trace.NAME` of a run.
struct PartTraceSettings {
  Settings all;
  run::TraceSettings trace{all};

  /// From an object of names (without `trace.`) and values. An Error: there is no such setting, or
  /// a wrong value.
  std::optional<Error> set(const Json& values);
  bool any() const;
  /// The files that they write.
  std::vector<host::FileUse> outputs() const;
};

/// Traces a simulation from where it stands, between two instructions: what the observer of a run
/// does, for a part. Changes its speed and nothing else. Board and settings must outlive it; the
/// board is not advanced after the end of its life.
class PartTraces {
 public:
  /// An Error: an output that is a file of the simulation or cannot be written, or a wrong bound.
  static Result<std::unique_ptr<PartTraces>> begin(Board& board, const PartTraceSettings& wanted);

  /// Completes the files. Of the result: `lost`, and `profile` if there is one.
  run::RunResult end();

 private:
  PartTraces(Board& board, const PartTraceSettings& wanted)
      : traces_(board.simulation().view(), wanted.trace, board.settings().coprocessor) {}

  run::Traces traces_;
};

}  // namespace capsoc::service
