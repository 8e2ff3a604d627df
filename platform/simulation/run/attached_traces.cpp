#include "run/attached_traces.h"

#include <spdlog/spdlog.h>

#include "run/run_settings.h"

namespace capsoc::run {
namespace {

trace::TraceOptions trace_options(const RunSettings& settings) {
  trace::TraceOptions options;
  options.instructions = settings.trace.instructions();
  options.bus = settings.trace.bus();
  options.profile = settings.trace.profile();
  options.waves = settings.trace.waves();
  options.translation = settings.trace.translation();
  options.perf_map = settings.trace.perf_map();
  if (options.waves.empty() && settings.coprocessor.backend() == Backend::model)
    options.waves = settings.coprocessor.waves();
  options.start = settings.trace.start();
  options.stop = settings.trace.stop();
  options.depth = static_cast<std::size_t>(settings.trace.depth());
  options.fetches = settings.trace.fetches();
  return options;
}

}  // namespace

Result<std::unique_ptr<trace::Tracer>> attach_tracer(const RunSettings& settings,
                                                     const ProgramView& view) {
  const trace::TraceOptions options = trace_options(settings);
  if (settings.coprocessor.backend() == Backend::model && !settings.trace.waves().empty() &&
      !settings.coprocessor.waves().empty())
    return Error{
        "--waves and --trace-waves are the same waves with --coprocessor tlm; give one of them"};
  if (!options.any()) return std::unique_ptr<trace::Tracer>();
  const source::Program& program = view.program();
  return trace::Tracer::attach(view.soc(), options, program.images(),
                               [&program](uint32_t address) { return program.line_at(address); });
}

Result<std::unique_ptr<trace::Coverage>> attach_coverage(const RunSettings& settings,
                                                         const ProgramView& view) {
  const std::string file = settings.trace.coverage();
  if (file.empty()) return std::unique_ptr<trace::Coverage>();
  return trace::Coverage::attach(view.soc(), view.program(), file);
}

void warn_of_missing_lines(const RunSettings& settings, const ProgramView& view) {
  if (settings.trace.profile().empty() && settings.trace.coverage().empty()) return;
  for (const std::string& sentence : view.program().damage()) spdlog::warn("{}", sentence);
}

}  // namespace capsoc::run
