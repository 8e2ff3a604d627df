// A run with a random fault, compared with the run without it, as a kind of work.
#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <set>

#include "campaign/kinds.h"
#include "campaign/work_settings.h"
#include "fault/draw.h"
#include "fault/golden.h"
#include "fault/trial.h"
#include "host/child_process.h"
#include "host/descriptor.h"
#include "host/end_signals.h"
#include "host/files.h"
#include "host/sha256.h"
#include "host/temporary_folder.h"
#include "results/exit_codes.h"
#include "results/results.h"
#include "session/run_files.h"
#include "session/run_settings.h"

namespace capsoc::campaign {
namespace {

/// The settings of a run and, beginning with "fault.", those of its fault.
struct FaultSettings {
  run::RunSettings run;
  fault::TrialSettings trial;

  /// Nothing of what was set before stays.
  std::optional<Error> set(const std::vector<Assignment>& assignments) {
    run.forget_values();
    trial.forget_values();
    std::vector<Assignment> of_run, of_trial;
    for (const Assignment& each : assignments)
      (each.path.rfind("fault.", 0) == 0 ? of_trial : of_run).push_back(each);
    if (auto error = set_all(of_run, run)) return error;
    if (auto error = set_all(of_trial, trial)) return error;
    for (const TextField* field : {&run.inject.faults, &run.inject.file, &run.checkpoint.restore})
      if (!field->empty())
        return Error{fmt::format(
            "{}: {}: a campaign of faults has its own; leave it out, or give fault.line",
            field->about().origin, field->about().path)};
    const double from = trial.from_s(), to = trial.to_s(), until = trial.until_s();
    if (from >= to || to >= until)
      return Error{
          fmt::format("{}: fault.from_s {:.6g}, fault.to_s {:.6g} and fault.until_s {:.6g} are not "
                      "in this order; "
                      "make each later than the one before",
                      origin_of_span(), from, to, until)};
    return std::nullopt;
  }

  /// Of the first of its settings that was set; of none, the name of the last one.
  std::string origin_of_span() const {
    for (const NumberField* field : {&trial.from_s, &trial.to_s, &trial.until_s})
      if (!field->is_built_in()) return field->about().origin;
    return trial.until_s.about().path;
  }

  fault::Span span() const { return {trial.from_s(), trial.to_s(), trial.until_s()}; }
};

class FaultWork final : public Work {
 public:
  Result<Job> prepare(const std::vector<Assignment>& assignments) override {
    if (auto error = settings_.set(assignments)) return *error;
    const fault::TrialSettings& trial = settings_.trial;
    Job job;
    job.identity = run_identity(settings_.run) + settings_identity(trial);
    job.command = run::reproducing_command(settings_.run);
    job.command += fmt::format(" --inject '{}'",
                               trial.line.empty() ? "(fault.line of the result)" : trial.line());
    return job;
  }

  std::optional<Error> check(const std::vector<Assignment>& assignments, const Keep&) override {
    // Ended by one it removes its folder.
    host::note_end_signals();
    if (!folder_) {
      auto folder = host::TemporaryFolder::make("faults");
      if (!folder) return Error{"the runs without faults: " + folder.error()};
      folder_.emplace(std::move(folder.value()));
    }
    if (auto error = settings_.set(assignments)) return error;
    if (const auto inputs = run::read_inputs(settings_.run); !inputs) return Error{inputs.error()};
    if (!checked_.insert(decides_on_places(settings_)).second) return std::nullopt;
    const auto drawn = draw();
    return drawn ? std::nullopt : std::make_optional(Error{drawn.error()});
  }

  Result<nlohmann::ordered_json> perform(const std::vector<Assignment>& assignments,
                                         const Keep&) override {
    if (auto error = settings_.set(assignments)) return *error;
    spdlog::set_level(spdlog::level::off);
    const auto drawn = draw();
    if (!drawn) return Error{drawn.error()};
    const auto& [place, golden, chosen] = drawn.value();
    const bool is_endless = golden.code == run::exit_code::limit;
    const double limit_s = golden.ended_s + (is_endless ? 0 : settings_.trial.wait_s());
    for (const auto& [path, value] :
         {std::pair<const char*, std::string>("inject.faults", chosen.line),
          {"run.simlimit_s", fmt::format("{}", limit_s)}})
      if (auto error =
              settings_.run.set(path, value, SettingSource::command_line, "the drawn fault"))
        return *error;
    const auto outcome = outcome_of(place, golden, chosen);
    if (!outcome) return Error{outcome.error()};
    return json_of(outcome.value(), chosen, run::reproducing_command(settings_.run));
  }

  nlohmann::ordered_json example() const override {
    fault::Outcome outcome;
    outcome.by = "some";
    outcome.after = 0;
    outcome.not_simulated = "some";
    return json_of(outcome, {"some", "some", 0, "some", 0}, "");
  }

  const std::vector<std::string>& host_keys() const override {
    static const std::vector<std::string> none;
    return none;
  }

 private:
  Result<fault::Outcome> outcome_of(const std::string& place, const fault::Golden& golden,
                                    const fault::Drawn& chosen) const {
    const fault::TrialSettings& trial = settings_.trial;
    if (trial.prune() && trial.line.empty() && trial.kind() == inject::Fault::Kind::flip) {
      fault::Outcome latent;
      latent.not_simulated = fault::reason_not_read(chosen.place, chosen.bit, golden.unread);
      if (!latent.not_simulated.empty()) return latent;
    }
    auto state = fault::read_state(place, chosen.start);
    if (!state) return Error{state.error()};
    return fault::try_fault(settings_.run, trial, chosen, golden, std::move(state.value()));
  }

  static nlohmann::ordered_json json_of(const fault::Outcome& outcome, const fault::Drawn& drawn,
                                        const std::string& command) {
    const char* const verdict = fault::name_of(outcome.verdict);
    const bool is_silent = outcome.verdict == fault::Verdict::silent;
    nlohmann::ordered_json j;
    j["exit"] = {
        {"code", static_cast<int>(is_silent ? run::exit_code::failed : run::exit_code::pass)},
        {"reason", verdict}};
    j["versions"] = run::versions();
    j["command"] = command;
    j["fault"] = {
        {"line", drawn.line}, {"unit", drawn.unit}, {"place", drawn.place}, {"bit", drawn.bit}};
    j["verdict"] = verdict;
    j["detected"] = {{"by", nullptr}, {"after_samples", nullptr}};
    if (!outcome.by.empty()) j["detected"]["by"] = outcome.by;
    if (outcome.after) j["detected"]["after_samples"] = *outcome.after;
    j["error_deg"] = outcome.largest_deg;
    j["trusted_wrong_samples"] = outcome.trusted;
    j["simulated_s"] = outcome.simulated_s;
    if (!outcome.not_simulated.empty()) j["not_simulated"] = outcome.not_simulated;
    return j;
  }

  /// What mostly decides whether there is a place to draw from. To draw takes the run without a
  /// fault, so one for each of these is enough; those of other settings come when the campaign
  /// runs.
  static std::string decides_on_places(const FaultSettings& settings) {
    return fmt::format("{}\n{}\n{}", settings.run.coprocessor.backend.text(),
                       settings.trial.units(), settings.trial.line());
  }

  /// A fault, with the golden run and the folder of its states.
  struct DrawnFault {
    std::string place;
    fault::Golden golden;
    fault::Drawn fault;
  };

  Result<DrawnFault> draw() {
    auto place = golden_folder();
    if (!place) return Error{place.error()};
    auto golden = fault::read_golden(place.value());
    if (!golden) return Error{golden.error()};
    auto drawn = fault::draw(settings_.trial, golden.value());
    if (!drawn) return Error{drawn.error()};
    return DrawnFault{std::move(place.value()), std::move(golden.value()),
                      std::move(drawn.value())};
  }

  /// Where the golden run of these settings is. The first worker that needs it performs it, in a
  /// separate process; the others wait.
  Result<std::string> golden_folder() {
    const fault::Span span = settings_.span();
    std::string name =
        host::sha256_of(run_identity(settings_.run) +
                        fmt::format("{} {} {}", span.from_s, span.to_s, span.until_s));
    std::string place = folder_->path() + "/" + name.substr(0, 16);
    std::error_code failure;
    std::filesystem::create_directories(place, failure);
    const host::Descriptor lock(
        open((place + "/lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600));
    if (!lock.valid()) return host::cannot_write(place + "/lock", errno);
    while (flock(lock.get(), LOCK_EX) != 0 && errno == EINTR) {
    }
    if (fault::has_golden(place)) return place;
    if (auto error = perform_golden(settings_, place)) return *error;
    return place;
  }

  /// In the process for it. A program without an end gets one, some time after the last look at the
  /// state.
  static Result<fault::Golden> record(FaultSettings& settings, const std::string& place) {
    run::RunSettings& run = settings.run;
    if (run.limits.simulated_s() == 0)
      if (auto error = run.set("run.simlimit_s", fmt::format("{}", 2 * settings.trial.until_s()),
                               SettingSource::command_line, "the run without a fault"))
        return *error;
    auto golden = fault::record_golden(run, settings.span(), place);
    if (golden) return golden;
    return Error{fmt::format("{}: {}", settings.origin_of_span(), golden.error())};
  }

  static std::optional<Error> perform_golden(FaultSettings& settings, const std::string& place) {
    const host::Apart apart = host::perform_apart([&]() -> std::string {
      host::leave_terminal();
      auto golden = record(settings, place);
      const auto error = golden ? fault::write_golden(golden.value(), place)
                                : std::optional<Error>(Error{golden.error()});
      return error ? error->text : "";
    });
    if (apart.end == host::Apart::End::not_started)
      return Error{"the run without a fault cannot be started; give fewer --jobs"};
    if (host::noted_signal() != 0) return Error{"a signal ended the run without a fault"};
    if (apart.end == host::Apart::End::crashed)
      return Error{"the run without a fault crashed; try it with capsoc run"};
    if (!apart.text.empty()) return Error{apart.text};
    return std::nullopt;
  }

  /// For golden runs, which all workers share.
  std::optional<host::TemporaryFolder> folder_;
  std::set<std::string> checked_;  // decides_on_places() of those
  FaultSettings settings_;  // of one run in turn: to declare them takes far longer than to set
};

}  // namespace

std::unique_ptr<Work> make_fault_work() {
  return std::make_unique<FaultWork>();
}

}  // namespace capsoc::campaign
