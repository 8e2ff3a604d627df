#include "service/outputs.h"

#include <exception>

#include "backend/coprocessor_backend.h"
#include "service/board.h"
#include "session/run_files.h"
#include "session/run_settings.h"

namespace capsoc::service {
namespace {

/// Other clients wait meanwhile: what is longer is none that a person would write.
constexpr std::size_t longest_text = 16384, most_outputs = 100;

std::vector<host::FileUse> outputs_in(const Json& settings) {
  run::RunSettings known;
  std::size_t length = 0;
  for (const auto& [name, value] : settings.items()) {
    const auto text = setting_text(value);
    if (name == "history_mb" || !text) continue;
    length += text->size();
    if (length > longest_text) return {};
    if (known.set(name, *text, SettingSource::command_line, "settings")) return {};
  }
  const bool are_named = !known.coprocessor.waves.empty();
  std::vector<host::FileUse> outputs;
  for (host::FileUse& use : run::files_of(known))
    if (use.kind == host::FileUse::Kind::output && !use.path.empty() &&
        (are_named || use.path != run::lockstep_waves(known.coprocessor)))
      outputs.push_back(std::move(use));
  if (outputs.size() > most_outputs) outputs.resize(most_outputs);
  return outputs;
}

}  // namespace

std::vector<host::FileUse> outputs_of(const Json& settings) {
  // The worker, which reads them too, answers what is wrong with them; it may also fail.
  try {
    return outputs_in(settings);
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace capsoc::service
