// capsoc campaign: many runs from one description, in a store that survives everything.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "campaign/campaign.h"
#include "campaign/export.h"
#include "campaign/report.h"
#include "campaign/slurm.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/whole_number.h"
#include "host/end_signals.h"
#include "host/file_uses.h"
#include "host/files.h"
#include "report/page.h"
#include "workers/progress.h"

namespace capsoc::cli {
namespace {

constexpr double longest_trial_s = 60;
constexpr std::size_t shown_commands = 3;

struct CampaignArguments {
  std::string description, store;
  std::vector<std::string> stores;
  std::string json, junit, html, csv;
  std::string shard;
  campaign::SlurmPlan slurm;
  bool scripts_only = false;
  campaign::RunOptions run;
  campaign::ExportOptions columns;
};

host::FileUse read_by(const char* name, const std::string& path) {
  return {host::FileUse::Kind::input, name, path};
}

host::FileUse written_by(const char* name, const std::string& path) {
  return {host::FileUse::Kind::output, name, path};
}

/// In the current folder and not next to an input, with the description's name.
std::string store_of(const CampaignArguments& a) {
  if (!a.store.empty()) return a.store;
  return std::filesystem::path(a.description).stem().string() + ".sqlite";
}

/// No output is an input or another output, and those that are written at the end can be.
std::optional<Error> check_files(const std::vector<host::FileUse>& inputs,
                                 const std::vector<host::FileUse>& outputs) {
  std::vector<host::FileUse> uses = inputs;
  uses.insert(uses.end(), outputs.begin(), outputs.end());
  if (auto error = host::check_uses(uses)) return error;
  for (const host::FileUse& use : outputs)
    if (!use.path.empty())
      if (auto error = host::check_writable(use.path)) return error;
  return std::nullopt;
}

std::vector<host::FileUse> reports_of(const CampaignArguments& a) {
  return {written_by("--json", a.json), written_by("--junit", a.junit),
          written_by("--html", a.html)};
}

/// "K/N".
std::optional<Error> read_shard(CampaignArguments& a) {
  if (a.shard.empty()) return std::nullopt;
  constexpr uint64_t most = 1'000'000;
  uint64_t part = 0, whole = 0;
  char rest = 0;
  if (std::sscanf(a.shard.c_str(), "%7lu/%7lu%c", &part, &whole, &rest) == 2 && part >= 1 &&
      part <= whole && whole <= most) {
    a.run.shard = {part, whole};
    return std::nullopt;
  }
  return Error{fmt::format("--shard {}: write K/N, K from 1 to N, N at most {}", a.shard, most)};
}

Result<campaign::Plan> plan_of(const std::string& file) {
  auto description = campaign::read_description(file);
  if (!description) return Error{description.error()};
  auto program = campaign::Program::own();
  if (!program) return Error{program.error()};
  return campaign::Plan::make(std::move(description.value()), program.value());
}

int check_command(const CampaignArguments& a) {
  const auto plan = plan_of(a.description);
  if (!plan) return refuse(plan.error());
  const campaign::Plan& p = plan.value();
  host::print("campaign {} ({}): {} runs", p.description().name, p.description().kind,
              p.runs().size());
  if (p.duplicates() > 0) host::print(", {} more are the same as these", p.duplicates());
  host::print(", seed {}\n", p.description().seed);
  for (std::size_t i = 0; i < std::min(shown_commands, p.runs().size()); ++i) {
    const auto command = p.command(p.runs()[i]);
    if (!command) return refuse(command.error());
    host::print("  {}\n", command.value());
  }
  std::fflush(stdout);
  const auto seconds = campaign::time_one(p, longest_trial_s);
  if (const int signal = host::noted_signal(); signal != 0)
    return run::exit_code::signal_base + signal;
  if (!seconds) {
    host::print("the first run gives no estimate of time: {}\n", seconds.error());
    return run::exit_code::pass;
  }
  const double all = seconds.value() * static_cast<double>(p.runs().size());
  host::print("the first run takes {:.2f} s, all of them about {} with --jobs {}\n",
              seconds.value(), workers::duration_text(all / a.run.jobs), a.run.jobs);
  return run::exit_code::pass;
}

/// The files that were asked for, and the text.
int print_report(const CampaignArguments& a, const campaign::Store& store) {
  const auto report = campaign::make_report(store);
  if (!report) return refuse(report.error());
  std::vector<host::TextFile> files;
  std::vector<report::ResultFile> results(1);
  if (!a.json.empty() || !a.html.empty()) results.front().json = campaign::to_json(report.value());
  if (!a.json.empty()) files.push_back({a.json, run::to_text(results.front().json)});
  if (!a.html.empty()) files.push_back({a.html, report::page_of(results)});
  if (!a.junit.empty()) {
    auto text = campaign::to_junit(store);
    if (!text) return refuse(text.error());
    files.push_back({a.junit, std::move(text.value())});
  }
  host::print("{}", campaign::to_text(report.value()));
  const campaign::Report& r = report.value();
  const bool good =
      a.run.shard.whole > 1 ? r.done > 0 && r.yield() >= r.least_yield : r.reaches_yield();
  const int code = good ? run::exit_code::pass : run::exit_code::failed;
  if (const auto error = host::write_together(files))
    return refuse(error->text, good ? run::exit_code::lost : code);
  return code;
}

int perform(const CampaignArguments& a, const campaign::Plan& plan, campaign::Store& store) {
  if (const uint64_t seed = plan.description().seed; !plan.runs().empty())
    host::say("{} runs, seed {}, store {}\n", plan.runs().size(), seed, store.path());
  const auto done = campaign::perform(plan, store, a.run);
  // What was done is in the store, and the command continues from there.
  if (!done) return refuse(done.error(), run::exit_code::lost);
  const int code = print_report(a, store);
  const int signal = host::noted_signal();
  if (signal == 0) return code;
  host::say("capsoc: ended by signal {}; capsoc campaign resume {} continues\n", signal,
            store.path());
  return run::exit_code::signal_base + signal;
}

int run_command(CampaignArguments& a) {
  if (auto error = read_shard(a)) return refuse(error->text);
  const std::string path = store_of(a);
  const std::vector<host::FileUse> inputs = {read_by("FILE", a.description),
                                             written_by("--store", path)};
  if (auto error = check_files(inputs, reports_of(a))) return refuse(error->text);
  const auto plan = plan_of(a.description);
  if (!plan) return refuse(plan.error());
  const auto store = campaign::Store::open(path);
  if (!store) return refuse(store.error());
  return perform(a, plan.value(), *store.value());
}

int resume_command(CampaignArguments& a) {
  if (auto error = read_shard(a)) return refuse(error->text);
  if (auto error = check_files({read_by("STORE", a.store)}, reports_of(a)))
    return refuse(error->text);
  const auto store = campaign::Store::open_existing(a.store);
  if (!store) return refuse(store.error());
  const auto stored = store.value()->plan();
  if (!stored) return refuse(stored.error());
  if (!stored.value())
    return refuse(a.store + ": holds no campaign yet; capsoc campaign run begins one");
  auto description = campaign::read_description(stored.value()->description, stored.value()->file);
  if (!description) return refuse(description.error());
  const auto program = campaign::Program::own();
  if (!program) return refuse(program.error());
  if (program.value().hash != stored.value()->program.hash)
    return refuse(
        fmt::format("{}: was begun by another program (capsoc {}) than this one (capsoc "
                    "{}); resume with that, or begin again with capsoc campaign run",
                    a.store, stored.value()->program.version, program.value().version));
  const auto plan = campaign::Plan::make(std::move(description.value()), program.value());
  if (!plan) return refuse(plan.error());
  return perform(a, plan.value(), *store.value());
}

int slurm_command(CampaignArguments& a) {
  const auto plan = plan_of(a.description);
  if (!plan) return refuse(plan.error());
  a.slurm.description = a.description;
  a.slurm.name = plan.value().description().name;
  a.slurm.store = store_of(a);
  if (a.slurm.folder.empty())
    a.slurm.folder = std::filesystem::path(a.description).stem().string() + ".slurm";
  if (auto error =
          host::check_uses({read_by("FILE", a.description), written_by("--store", a.slurm.store),
                            written_by("the copy of FILE", a.slurm.folder + "/campaign.toml")}))
    return refuse(error->text);
  const auto scripts = campaign::write_scripts(a.slurm);
  if (!scripts) return refuse(scripts.error());
  host::print("{} runs in {} tasks: {}, then {}\n", plan.value().runs().size(), a.slurm.tasks,
              scripts.value().array, scripts.value().last);
  if (a.scripts_only) return run::exit_code::pass;
  const auto jobs = campaign::submit(scripts.value());
  if (!jobs) return refuse(jobs.error());
  host::print("array {}, report {}: {} and {}/report.json\n", jobs.value().array, jobs.value().last,
              a.slurm.store, a.slurm.folder);
  return run::exit_code::pass;
}

int report_command(const CampaignArguments& a) {
  if (auto error = check_files({read_by("STORE", a.store)}, reports_of(a)))
    return refuse(error->text);
  const auto store = campaign::Store::read(a.store);
  if (!store) return refuse(store.error());
  return print_report(a, *store.value());
}

int merge_command(const CampaignArguments& a) {
  std::vector<host::FileUse> uses;
  for (const std::string& store : a.stores) uses.push_back(read_by("STORE", store));
  uses.push_back(written_by("INTO", a.store));
  if (auto error = host::check_uses(uses)) return refuse(error->text);
  const auto into = campaign::Store::open(a.store);
  if (!into) return refuse(into.error());
  const auto taken = campaign::merge(*into.value(), a.stores);
  if (!taken) return refuse(taken.error());
  host::say("{} runs taken into {}\n", taken.value(), a.store);
  return run::exit_code::pass;
}

int export_command(const CampaignArguments& a) {
  if (auto error = check_files({read_by("STORE", a.store)},
                               {written_by("--csv", a.csv), written_by("--json", a.json)}))
    return refuse(error->text);
  const auto store = campaign::Store::read(a.store);
  if (!store) return refuse(store.error());
  std::vector<host::TextFile> files;
  if (!a.csv.empty() || a.json.empty()) {
    auto text = campaign::to_csv(*store.value(), a.columns);
    if (!text) return refuse(text.error());
    files.push_back({a.csv.empty() ? "/dev/stdout" : a.csv, std::move(text.value())});
  }
  if (!a.json.empty()) {
    auto text = campaign::to_columns(*store.value(), a.columns);
    if (!text) return refuse(text.error());
    files.push_back({a.json, std::move(text.value())});
  }
  if (a.csv.empty() && a.json.empty()) {
    host::print("{}", files.front().text);
    return run::exit_code::pass;
  }
  const auto error = host::write_together(files);
  return error ? refuse(error->text, run::exit_code::lost) : run::exit_code::pass;
}

using Arguments = std::shared_ptr<CampaignArguments>;

CLI::App* add(CLI::App& group, const char* name, const char* help, const Arguments& a, int& code,
              int (*command)(CampaignArguments&)) {
  CLI::App* added = group.add_subcommand(name, help);
  added->callback([a, &code, command] { code = command(*a); });
  return added;
}

void add_description(CLI::App& command, const Arguments& a) {
  command.add_option("file", a->description, "Description of the campaign (TOML)")
      ->required()
      ->type_name("FILE");
}

void add_store(CLI::App& command, const Arguments& a) {
  command.add_option("store", a->store, "Store of a campaign")->required()->type_name("STORE");
}

void add_jobs(CLI::App& command, const Arguments& a) {
  command.add_option("--jobs", a->run.jobs, "Worker processes; the rows do not depend on it")
      ->transform(whole_number(1, 1024));
}

void add_working(CLI::App& command, const Arguments& a) {
  add_jobs(command, a);
  command
      .add_option("--shard", a->shard, "Only part K of N, by key: for schedulers and CI matrices")
      ->type_name("K/N");
  command.add_flag("--retry", a->run.retry,
                   "Do runs again that crashed or hit a limit of the campaign");
}

void add_reports(CLI::App& command, const Arguments& a) {
  command.add_option("--json", a->json, "Write the report as JSON")->type_name("FILE");
  command.add_option("--junit", a->junit, "Write the runs as JUnit XML")->type_name("FILE.xml");
  command.add_option("--html", a->html, "Write a report with figures that a browser shows offline")
      ->type_name("FILE");
}

void add_slurm(CLI::App& group, const Arguments& a, int& code) {
  CLI::App* command =
      add(group, "slurm", "Submit the runs as a job array of Slurm", a, code, slurm_command);
  add_description(*command, a);
  command->add_option("--tasks", a->slurm.tasks, "Tasks of the array, each with its shard")
      ->required()
      ->transform(whole_number(1, 100'000));
  command->add_option("--store", a->store, "Where all runs come together (default: FILE's name)")
      ->type_name("STORE");
  command
      ->add_option("--folder", a->slurm.folder,
                   "For scripts, logs and the tasks' stores (default: FILE's name.slurm)")
      ->type_name("DIR");
  command
      ->add_option("--sbatch", a->slurm.options,
                   "An option of sbatch for all jobs; may be repeated")
      ->type_name("OPTION")
      ->allow_extra_args(false);
  command->add_flag("--no-submit", a->scripts_only, "Write the scripts and submit nothing");
}

void add_export(CLI::App& group, const Arguments& a, int& code) {
  CLI::App* command = add(group, "export", "Write the runs as a table; CSV on standard output", a,
                          code, [](CampaignArguments& x) { return export_command(x); });
  add_store(*command, a);
  command->add_option("--csv", a->csv, "Write it to a file")->type_name("FILE.csv");
  command
      ->add_option("--json", a->json,
                   "Write a list for each column: pandas.DataFrame(json.load(file))")
      ->type_name("FILE.json");
  command->add_flag("--all", a->columns.all_keys, "All keys of the results, not only the metrics");
  command->add_flag("--times", a->columns.times, "Times of the host, too");
}

}  // namespace

void add_campaign(CLI::App& app, int& code) {
  auto a = std::make_shared<CampaignArguments>();
  a->run.jobs = std::max(1u, std::thread::hardware_concurrency());
  CLI::App* group = app.add_subcommand(
      "campaign", "Many runs from one description, in a store that can be resumed and merged");
  group->require_subcommand(1);

  CLI::App* check = add(*group, "check", "Say how many runs a description makes, and how long", a,
                        code, [](CampaignArguments& x) { return check_command(x); });
  add_description(*check, a);
  add_jobs(*check, a);

  CLI::App* run = add(*group, "run", "Do the runs that the store does not have, and report", a,
                      code, run_command);
  add_description(*run, a);
  run->add_option("--store", a->store, "SQLite file for the runs (default: FILE's name.sqlite)")
      ->type_name("STORE");
  add_working(*run, a);
  add_reports(*run, a);

  CLI::App* resume = add(*group, "resume", "Resume where a store ends", a, code, resume_command);
  add_store(*resume, a);
  add_working(*resume, a);
  add_reports(*resume, a);

  CLI::App* report = add(*group, "report", "Yield, distributions, the worst runs of a store", a,
                         code, [](CampaignArguments& x) { return report_command(x); });
  add_store(*report, a);
  add_reports(*report, a);

  CLI::App* merge = add(*group, "merge", "Take the runs of several stores into one", a, code,
                        [](CampaignArguments& x) { return merge_command(x); });
  merge->add_option("into", a->store, "Store that takes them; made if it is not there")
      ->required()
      ->type_name("INTO");
  merge->add_option("stores", a->stores, "Stores of the same campaign")
      ->required()
      ->type_name("STORE");
  add_slurm(*group, a, code);
  add_export(*group, a, code);
}

}  // namespace capsoc::cli
