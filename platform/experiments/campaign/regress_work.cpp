// `capsoc regress`, a scenario with a seed, as a kind of work.
#include <fmt/format.h>

#include "base/setting_fields.h"
#include "campaign/kinds.h"
#include "campaign/work_settings.h"
#include "regress/campaign.h"
#include "regress/rtl_comparison.h"
#include "regress/scenario.h"
#include "results/results.h"
#include "rtl/rtl_library.h"

namespace capsoc::campaign {
namespace {

std::vector<ChoiceField<const regress::Scenario*>::Choice> all_scenarios() {
  std::vector<ChoiceField<const regress::Scenario*>::Choice> choices;
  for (const regress::Scenario& scenario : regress::scenarios())
    choices.push_back({scenario.name, &scenario});
  return choices;
}

class RegressSettings : public Settings {
 public:
  ChoiceField<const regress::Scenario*> scenario{
      *this, all_scenarios(),
      setting("regress.scenario", SettingKind::choice, regress::scenarios().front().name,
              "which one (capsoc regress --list)")};
  ChoiceField<coprocessor::Arithmetic> arithmetic{
      *this,
      {{"precise", coprocessor::Arithmetic::precise}, {"paper", coprocessor::Arithmetic::paper}},
      setting("regress.arithmetic", SettingKind::choice, "precise", "which of them")};
  IntegerField seed{
      *this, setting("regress.seed", SettingKind::integer, "1", "of the stimulus").in(0, 0x1p53)};
  IntegerField samples{*this, setting("regress.samples", SettingKind::integer, "10000",
                                      "random samples of the scenario")
                                  .in(0, 1e12)};
  IntegerField accesses{*this, setting("regress.accesses", SettingKind::integer, "1000",
                                       "random bus accesses of the scenario")
                                   .in(0, 1e12)};
  TextField library{*this, setting("regress.rtl_library", SettingKind::input, "",
                                   "Verilated coprocessor; empty: capsoc's own")};

  std::string library_file() const {
    return library.empty() ? rtl::RtlLibrary::file_name(arithmetic(), false) : library();
  }

  regress::Plan plan() const {
    regress::Plan plan;
    plan.arithmetics = {arithmetic()};
    plan.first_seed = static_cast<uint64_t>(seed());
    plan.samples = static_cast<uint64_t>(samples());
    plan.accesses = static_cast<uint64_t>(accesses());
    plan.scenarios = {scenario()->name};
    if (!library.empty()) plan.command_options = "--rtl-library " + library();
    return plan;
  }
};

Result<rtl::RtlLibrary::Handle> open(const RegressSettings& settings) {
  coprocessor::Options options;
  options.arithmetic = settings.arithmetic();
  auto library =
      rtl::RtlLibrary::open(settings.library_file(), options, rtl::RtlLibrary::Use::at_its_pins);
  if (!library) return Error{library.error()};
  return library.value();
}

nlohmann::ordered_json json_of(const regress::Run& run, const regress::Coverage* coverage) {
  nlohmann::ordered_json j;
  const bool same = !run.finding;
  const bool differ = !same && run.finding->kind == regress::Finding::Kind::difference;
  const int code = same     ? run::exit_code::pass
                   : differ ? run::exit_code::diverged
                            : run::exit_code::failed;
  j["exit"] = {{"code", code}, {"reason", same ? "no difference" : run.finding->what}};
  j["versions"] = run::versions();
  j["command"] = run.command;
  j["samples"] = run.counts.samples;
  j["accesses"] = run.counts.accesses;
  j["commits"] = run.counts.commits;
  j["cycles"] = run.counts.edges;
  uint64_t bins = 0, hit = 0;
  if (coverage != nullptr)
    for (const regress::Coverage::Bin& bin : coverage->bins()) {
      ++bins;
      hit += bin.hits > 0 ? 1 : 0;
      j["hits"][bin.group][bin.name] = bin.hits;
    }
  j["coverage"] = {{"bins", bins}, {"hit", hit}};
  j["difference"] = {{"cycle", nullptr}, {"node", nullptr}, {"report", nullptr}};
  if (!same)
    j["difference"] = {{"cycle", run.finding->cycle},
                       {"node", run.finding->node},
                       {"report", run.finding->report}};
  return j;
}

class RegressWork final : public Work {
 public:
  Result<Job> prepare(const std::vector<Assignment>& assignments) override {
    RegressSettings settings;
    if (auto error = set_all(assignments, settings)) return *error;
    const auto runs = regress::runs_of(settings.plan());
    if (!runs) return Error{runs.error()};
    return Job{settings_identity(settings) + input_identity(settings.library_file()),
               runs.value().front().command};
  }

  std::optional<Error> check(const std::vector<Assignment>& assignments, const Keep&) override {
    RegressSettings settings;
    if (auto error = set_all(assignments, settings)) return error;
    const auto library = open(settings);
    return library ? std::nullopt : std::make_optional(Error{library.error()});
  }

  Result<nlohmann::ordered_json> perform(const std::vector<Assignment>& assignments,
                                         const Keep&) override {
    RegressSettings settings;
    if (auto error = set_all(assignments, settings)) return *error;
    const auto library = open(settings);
    if (!library) return Error{library.error()};
    regress::Plan plan = settings.plan();
    plan.compare = [&](coprocessor::Arithmetic arithmetic) {
      coprocessor::Options options;
      options.arithmetic = arithmetic;
      return regress::compare_with_rtl(options, library.value());
    };
    auto runs = regress::runs_of(plan);
    if (!runs) return Error{runs.error()};
    regress::Run& run = runs.value().front();
    regress::Coverage coverage(run.arithmetic);
    if (auto error = regress::perform(plan, run, coverage)) return *error;
    return json_of(run, &coverage);
  }

  nlohmann::ordered_json example() const override {
    regress::Run run;
    run.finding.emplace();
    return json_of(run, nullptr);
  }

  const std::vector<std::string>& host_keys() const override {
    static const std::vector<std::string> none;
    return none;
  }
};

}  // namespace

std::unique_ptr<Work> make_regress_work() {
  return std::make_unique<RegressWork>();
}

}  // namespace capsoc::campaign
