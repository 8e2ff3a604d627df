// The traces and the coverage that the settings ask for.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "backend/coprocessor_settings.h"
#include "base/result.h"
#include "explain/program_view.h"
#include "observers/run_observer.h"
#include "observers/trace_settings.h"
#include "trace/coverage.h"
#include "trace/tracer.h"

namespace capsoc::run {

/// What the settings ask of a tracer.
trace::TraceOptions options_of(const TraceSettings& settings);

/// Attaches what the settings ask for. The waves of a run with the model alone are the SoC's, so
/// results.waves names them, too.
class Traces final : public RunObserver {
 public:
  Traces(const ProgramView& view, const TraceSettings& settings,
         const CoprocessorSettings& coprocessor)
      : view_(view), settings_(settings), coprocessor_(coprocessor) {}

  /// An Error as Tracer::attach() and Coverage::attach() have it.
  std::optional<Error> open() override;
  void restored() override;
  /// Warns of each part of the debug information that could not be read.
  void close(RunResult& result) override;
  void finish(RunResult& result) override;
  /// The same, with what the timeline says at its end.
  void finish(RunResult& result, const std::string& end);

 private:
  trace::TraceOptions options() const;
  std::optional<Error> attach_tracer();
  std::optional<Error> attach_coverage();

  const ProgramView& view_;
  const TraceSettings& settings_;
  const CoprocessorSettings& coprocessor_;
  std::unique_ptr<trace::Tracer> tracer_;      // null without
  std::unique_ptr<trace::Coverage> coverage_;  // null without
};

}  // namespace capsoc::run
