// `capsoc run` as a kind of work.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "campaign/kinds.h"
#include "campaign/work_settings.h"
#include "inputs/run_inputs.h"
#include "service/session_run.h"
#include "session/run_files.h"
#include "session/run_settings.h"
#include "session/simulation.h"

namespace capsoc::campaign {
namespace {

/// For a failed run that is repeated; lockstep writes its waves only when there is something to
/// see.
std::optional<Error> set_places(const Keep& keep, run::RunSettings& settings) {
  const auto place = [&](const TextField& field, const std::string& file) {
    return settings.set(field.about().path, file, SettingSource::command_line, "[keep]");
  };
  if (settings.coprocessor.backend() == run::Backend::lockstep)
    if (auto error = place(settings.coprocessor.waves, keep.stem + ".fst")) return error;
  if (!keep.failed || keep.stem.empty()) return std::nullopt;
  if (auto error = place(settings.results.record, keep.stem + ".csv")) return error;
  if (!keep.waves || settings.coprocessor.backend() == run::Backend::lockstep) return std::nullopt;
  return place(settings.coprocessor.waves, keep.stem + ".fst");
}

/// The run in a session, which is written.
Result<nlohmann::ordered_json> write_session(const Keep& keep, run::RunSettings& settings) {
  const std::pair<const Setting&, std::string> places[] = {
      {settings.results.session.about(), keep.stem + ".session"},
      {settings.results.keep_last_s.about(), fmt::format("{}", *keep.session_s)}};
  for (const auto& [setting, value] : places)
    if (auto error = settings.set(setting.path, value, SettingSource::command_line, "[keep]"))
      return *error;
  auto finished = service::run_in_session(settings);
  if (!finished) return Error{finished.error()};
  const auto& lost = finished.value().at("lost");
  if (!lost.empty()) return Error{lost.front().get<std::string>()};
  return nlohmann::ordered_json::object();
}

class RunWork final : public Work {
 public:
  bool has_sessions() const override { return true; }

  Result<Job> prepare(const std::vector<Assignment>& assignments) override {
    settings_.forget_values();
    if (auto error = set_all(assignments, settings_)) return *error;
    Job job;
    job.identity = run_identity(settings_);
    job.command = run::reproducing_command(settings_);
    return job;
  }

  std::optional<Error> check(const std::vector<Assignment>& assignments,
                             const Keep& keep) override {
    run::RunSettings settings;
    if (auto error = set_all(assignments, settings)) return error;
    // Without a name of its own every run's waves would go to the same file.
    const auto& backend = settings.coprocessor.backend;
    if (backend() == run::Backend::lockstep && keep.stem.empty())
      return Error{fmt::format(
          "{}: {} = lockstep writes the waves of a difference; say where by [keep] failures = "
          "\"FOLDER\"",
          backend.about().origin, backend.about().path)};
    const auto inputs = run::read_inputs(settings);
    return inputs ? std::nullopt : std::make_optional(Error{inputs.error()});
  }

  Result<nlohmann::ordered_json> perform(const std::vector<Assignment>& assignments,
                                         const Keep& keep) override {
    run::RunSettings settings;
    if (auto error = set_all(assignments, settings)) return *error;
    if (keep.session_s) return write_session(keep, settings);
    if (auto error = set_places(keep, settings)) return *error;
    spdlog::set_level(settings.log_level());
    auto result = run::run(settings);
    if (!result) return Error{result.error()};
    return run::to_json(result.value(), settings);
  }

  nlohmann::ordered_json example() const override {
    run::RunResult result;
    result.samples = 1;  // else there is nothing of the sensor
    result.translation.emplace();
    result.truth.emplace();
    result.convergence.state = metrics::Convergence::State::reached;
    result.errors = {true, 0, 0, 0, 0};
    result.verdict.emplace();
    result.verdict->pass = true;
    result.verdict->largest_error_deg = 0;
    result.golden.emplace();
    for (const char* name : {"a1", "a2", "b1", "b2", "beta"})
      result.golden->rows.push_back({name, 0, 0, 0, 0});
    result.golden->angle.difference = 0;
    result.golden->angle.bound.emplace();
    result.divergence = result.fault_report = result.place_report = "some";
    nlohmann::ordered_json example = run::to_json(result, run::RunSettings());
    result.golden->rejection = "some";
    example["golden"]["rejection"] = golden::to_json(*result.golden)["rejection"];
    return example;
  }

  const std::vector<std::string>& host_keys() const override {
    static const std::vector<std::string> keys = {"time.wall_s", "cpu.mips"};
    return keys;
  }

 private:
  run::RunSettings settings_;  // of one run after the other
};

}  // namespace

std::unique_ptr<Work> make_run_work() {
  return std::make_unique<RunWork>();
}

}  // namespace capsoc::campaign
