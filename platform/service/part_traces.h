// The traces of a part of a simulation.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "host/file_uses.h"
#include "observers/trace_settings.h"
#include "service/board.h"
#include "trace/coverage.h"
#include "trace/profile.h"
#include "trace/tracer.h"

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

/// Traces a simulation from where it stands, between two instructions. Changes its speed and
/// nothing else. The board must outlive it, and is not advanced after the end of its life.
class PartTraces {
 public:
  /// An Error: an output that is a file of the simulation or cannot be written, or a wrong bound.
  static Result<std::unique_ptr<PartTraces>> begin(Board& board, const PartTraceSettings& wanted);

  /// Completes the files. A sentence for each that is not whole.
  std::vector<std::string> end();
  /// After end(): those that took the most cycles; none without a profile.
  std::vector<trace::FunctionCost> functions() { return tracer_->top_functions(); }

 private:
  PartTraces() = default;

  std::unique_ptr<trace::Tracer> tracer_;
  std::unique_ptr<trace::Coverage> coverage_;  // null without
};

}  // namespace capsoc::service
