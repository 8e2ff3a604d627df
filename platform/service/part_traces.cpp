#include "service/part_traces.h"

#include <utility>

#include "base/printable.h"
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
  if (auto error = board.check_files(wanted.outputs())) return *error;
  std::unique_ptr<PartTraces> traces(new PartTraces(board, wanted));
  if (auto error = traces->traces_.open()) return *error;
  traces->traces_.restored();
  return traces;
}

run::RunResult PartTraces::end() {
  run::RunResult result;
  traces_.close(result);
  traces_.finish(result, "end of the trace");
  return result;
}

}  // namespace capsoc::service
