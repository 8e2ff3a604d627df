#include "observers/traces.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <string>
#include <utility>

namespace capsoc::run {

trace::TraceOptions options_of(const TraceSettings& settings) {
  trace::TraceOptions options;
  options.instructions = settings.instructions();
  options.bus = settings.bus();
  options.profile = settings.profile();
  options.waves = settings.waves();
  options.timeline = settings.timeline();
  options.translation = settings.translation();
  options.perf_map = settings.perf_map();
  options.start = settings.start();
  options.stop = settings.stop();
  options.depth = static_cast<std::size_t>(settings.depth());
  options.fetches = settings.fetches();
  return options;
}

trace::TraceOptions Traces::options() const {
  trace::TraceOptions options = options_of(settings_);
  if (options.waves.empty() && coprocessor_.backend() == Backend::model)
    options.waves = coprocessor_.waves();
  return options;
}

std::optional<Error> Traces::attach_tracer() {
  if (coprocessor_.backend() == Backend::model && !settings_.waves.empty() &&
      !coprocessor_.waves.empty())
    return Error{
        "--waves and --trace-waves are the same waves with --coprocessor tlm; give one of them"};
  const trace::TraceOptions wanted = options();
  if (!wanted.any()) return std::nullopt;
  const source::Program& program = view_.program();
  auto tracer =
      trace::Tracer::attach(view_.soc(), wanted, program.images(),
                            [&program](uint32_t address) { return program.line_at(address); });
  if (!tracer) return Error{tracer.error()};
  tracer_ = std::move(tracer.value());
  return std::nullopt;
}

std::optional<Error> Traces::attach_coverage() {
  if (settings_.coverage.empty()) return std::nullopt;
  auto coverage = trace::Coverage::attach(view_.soc(), view_.program(), settings_.coverage());
  if (!coverage) return Error{coverage.error()};
  coverage_ = std::move(coverage.value());
  return std::nullopt;
}

std::optional<Error> Traces::open() {
  if (auto error = attach_tracer()) return error;
  return attach_coverage();
}

void Traces::restored() {
  if (tracer_ != nullptr) tracer_->begin();
}

void Traces::close(RunResult& result) {
  if (tracer_ != nullptr)
    for (const Error& error : tracer_->finish()) result.lost.push_back(error.text);
  if (coverage_ != nullptr)
    if (const auto error = coverage_->finish()) result.lost.push_back(error->text);
  if (settings_.profile.empty() && settings_.coverage.empty()) return;
  for (const std::string& sentence : view_.program().damage()) spdlog::warn("{}", sentence);
}

void Traces::finish(RunResult& result) {
  finish(result, fmt::format("exit {}: {}", result.code, result.reason));
}

void Traces::finish(RunResult& result, const std::string& end) {
  if (tracer_ == nullptr) return;
  result.profile = tracer_->top_functions();
  if (const auto error = tracer_->finish_timeline(end)) result.lost.push_back(error->text);
}

}  // namespace capsoc::run
