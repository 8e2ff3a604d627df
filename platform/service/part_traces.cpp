#include "service/part_traces.h"

#include <utility>

#include "base/printable.h"
#include "observers/traces.h"
#include "session/run_files.h"
#include "trace/save_file.h"

namespace capsoc::service {
namespace {

constexpr const char* prefix = "trace.";

}  // namespace

std::optional<Error> PartTraceSettings::set(const Json& values) {
  for (const auto& [name, value] : values.items()) {
    const auto text = setting_text(value);
    if (!text)
      return Error{prefix + printable(name, 80) + " has to be a text, a number, true or false"};
    if (auto error = all.set(prefix + name, *text, SettingSource::command_line, "files"))
      return error;
  }
  return std::nullopt;
}

bool PartTraceSettings::any() const {
  return run::options_of(trace).any() || !trace.coverage.empty();
}

std::vector<host::FileUse> PartTraceSettings::outputs() const {
  using Kind = host::FileUse::Kind;
  std::vector<host::FileUse> uses;
  for (const Setting& setting : all.all())
    if (setting.kind == SettingKind::output)
      uses.push_back({Kind::output, setting.name(), setting.value});
  const TextField& waves = trace.waves;
  if (!waves.empty() && trace::save_file(waves()) != waves())
    uses.push_back({Kind::output, "the save file of " + waves.name(), trace::save_file(waves())});
  return uses;
}

Result<std::unique_ptr<PartTraces>> PartTraces::begin(Board& board,
                                                      const PartTraceSettings& wanted) {
  std::vector<host::FileUse> uses = run::files_of(board.settings());
  for (host::FileUse& use : wanted.outputs()) uses.push_back(std::move(use));
  if (auto error = host::check_uses(uses)) return *error;
  std::unique_ptr<PartTraces> traces(new PartTraces);
  const source::Program& program = board.simulation().view().program();
  auto tracer =
      trace::Tracer::attach(board.soc(), run::options_of(wanted.trace), program.images(),
                            [&program](uint32_t address) { return program.line_at(address); });
  if (!tracer) return Error{tracer.error()};
  traces->tracer_ = std::move(tracer.value());
  if (!wanted.trace.coverage.empty()) {
    auto coverage = trace::Coverage::attach(board.soc(), program, wanted.trace.coverage());
    if (!coverage) return Error{coverage.error()};
    traces->coverage_ = std::move(coverage.value());
  }
  traces->tracer_->begin();
  return traces;
}

std::vector<std::string> PartTraces::end() {
  std::vector<std::string> lost;
  for (const Error& error : tracer_->finish()) lost.push_back(error.text);
  if (const auto error = tracer_->finish_timeline("end of the trace")) lost.push_back(error->text);
  if (coverage_ != nullptr)
    if (const auto error = coverage_->finish()) lost.push_back(error->text);
  return lost;
}

}  // namespace capsoc::service
