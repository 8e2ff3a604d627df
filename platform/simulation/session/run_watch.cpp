#include "session/run_watch.h"

#include <unistd.h>

#include <memory>
#include <utility>

#include "observers/backend_outcome.h"
#include "observers/golden_check.h"
#include "observers/guest_errors.h"
#include "observers/printed_lines.h"
#include "observers/priority_report.h"
#include "observers/protocol_violations.h"
#include "observers/report_data.h"
#include "observers/sample_recording.h"
#include "observers/schedule.h"
#include "observers/stack_marks.h"
#include "observers/traces.h"
#include "observers/vector_report.h"
#include "observers/verdict_check.h"
#include "session/run_settings.h"

namespace capsoc::run {

template <typename T, typename... Arguments>
std::optional<Error> RunWatch::add(Arguments&&... arguments) {
  return observers_.add(std::make_unique<T>(std::forward<Arguments>(arguments)...));
}

std::optional<Error> RunWatch::observe_board() {
  auto observation = std::make_unique<Observation>(soc_, inputs_, isatty(STDERR_FILENO) != 0);
  observation_ = observation.get();
  if (auto error = observers_.add(std::move(observation))) return error;
  if (settings_.monitor())
    if (auto error = add<ProtocolViolations>(soc_)) return error;
  if (auto error = add<VerdictCheck>(inputs_.program, soc_, observation_->metrics())) return error;
  if (auto error = add<PriorityReport>(soc_, view_)) return error;
  return add<VectorReport>(soc_, view_);
}

std::optional<Error> RunWatch::observe_program() {
  if (auto error = add<GuestErrors>(view_)) return error;
  if (auto error = add<Traces>(view_, settings_.trace, settings_.coprocessor)) return error;
  if (auto error = add<StackMarks>(view_, settings_.stacks)) return error;
  if (auto error = add<Schedule>(view_, settings_.schedule)) return error;
  return add<BackendOutcome>(backend_, settings_.coprocessor, soc_, reproducing_command(settings_));
}

std::optional<Error> RunWatch::observe_outputs(const UartLines& uarts) {
  metrics::SampleProbe& samples = observation_->samples;
  if (!settings_.uarts.fail.empty())
    if (auto error = add<PrintedLines>(view_, uarts)) return error;
  if (settings_.golden())
    if (auto error = add<GoldenCheck>(soc_, samples)) return error;
  if (!settings_.results.record.empty()) {
    const std::string origin = "The coprocessor's samples of " + reproducing_command(settings_);
    if (auto error = add<SampleRecording>(settings_.results, origin, samples)) return error;
  }
  if (settings_.results.wants_curves())
    if (auto error = add<ReportGatherer>(samples, *soc_.uarts()[0])) return error;
  return std::nullopt;
}

}  // namespace capsoc::run
