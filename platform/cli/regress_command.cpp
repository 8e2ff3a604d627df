// capsoc regress: the C++ model and the RTL of the coprocessor against each other.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <thread>

#include "base/shell.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/whole_number.h"
#include "host/end_signals.h"
#include "host/file_uses.h"
#include "host/files.h"
#include "host/places.h"
#include "regress/report.h"
#include "regress/rtl_comparison.h"
#include "report/page.h"
#include "results/results.h"
#include "trace/save_file.h"
#include "workers/command.h"

namespace capsoc::cli {
namespace {

using coprocessor::Arithmetic;

constexpr uint64_t most_random = 1'000'000'000'000;
constexpr double least_line_percent = 100, least_toggle_percent = 98;

struct RegressArguments {
  std::string arithmetic = "both";
  regress::Plan plan;
  std::string library, junit, json, html;
  std::string exceptions = "rtl/verification/coverage_exceptions.txt";
  bool list = false, rebuild = false;
  int iteration_clocks = 1;
};

coprocessor::Options options_of(const RegressArguments& a, Arithmetic arithmetic) {
  coprocessor::Options options;
  options.arithmetic = arithmetic;
  options.paper_iteration_clocks = a.iteration_clocks;
  return options;
}

void list_scenarios() {
  for (const regress::Scenario& scenario : regress::scenarios())
    host::print("{:<16} {}\n", scenario.name, scenario.purpose);
}

std::string merged_coverage(const RegressArguments& a, Arithmetic arithmetic) {
  return fmt::format("{}/{}.dat", a.plan.coverage_directory, regress::name_of(arithmetic));
}

std::string library_of(const RegressArguments& a, Arithmetic arithmetic) {
  if (!a.library.empty()) return a.library;
  if (a.rebuild)
    return host::library_path(
        fmt::format("libcapsoc_rtl_{}_fast.so", regress::name_of(arithmetic)));
  if (a.iteration_clocks != 1) return rtl::RtlLibrary::file_name(options_of(a, arithmetic));
  return rtl::RtlLibrary::file_name(arithmetic, !a.plan.coverage_directory.empty());
}

/// No output is another file of the command, and all of them can be written.
std::optional<Error> check_files(const RegressArguments& a) {
  using Kind = host::FileUse::Kind;
  std::vector<host::FileUse> uses = {{Kind::output, "--junit", a.junit},
                                     {Kind::output, "--json", a.json},
                                     {Kind::output, "--html", a.html}};
  const bool coverage = !a.plan.coverage_directory.empty();
  if (coverage) uses.push_back({Kind::input, "--coverage-exceptions", a.exceptions});
  for (Arithmetic arithmetic : a.plan.arithmetics) {
    uses.push_back({Kind::input, "--rtl-library", library_of(a, arithmetic)});
    if (coverage) uses.push_back({Kind::output, "--coverage", merged_coverage(a, arithmetic)});
  }
  const auto runs = regress::runs_of(a.plan);
  if (!runs) return Error{runs.error()};
  for (const regress::Run& run : runs.value()) {
    uses.push_back({Kind::output, "--coverage", run.coverage_file});
    if (run.waves_file.empty()) continue;
    const std::string waves = run.waves_file + ".fst";
    uses.push_back({Kind::output, "--waves", waves});
    uses.push_back({Kind::output, "--waves", trace::save_file(waves)});
  }
  if (auto error = host::check_uses(uses)) return error;
  for (const host::FileUse& use : uses)
    if (use.kind == Kind::output && !use.path.empty())
      if (auto error = host::check_writable(use.path)) return error;
  // Read before an hour's work and not after it.
  if (!coverage) return std::nullopt;
  const auto exceptions = regress::CoverageExceptions::read(a.exceptions);
  return exceptions ? std::nullopt : std::make_optional(Error{exceptions.error()});
}

std::optional<Error> make_directory(const std::string& directory) {
  std::error_code failure;
  if (directory.empty() || std::filesystem::is_directory(directory, failure) ||
      std::filesystem::create_directories(directory, failure))
    return std::nullopt;
  return Error{fmt::format("the directory {} cannot be made: {}", directory, failure.message())};
}

/// Output of a build without its commands and progress.
std::string messages_of(const std::string& output) {
  std::string text;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    const bool own = line.rfind('[', 0) == 0 || line.rfind("FAILED: ", 0) == 0 ||
                     line.rfind("cd ", 0) == 0 || line.rfind("ninja: ", 0) == 0;
    if (!own) text += line + "\n";
  }
  return text;
}

/// Builds the libraries again from the RTL as it is, where this program was built.
std::optional<Error> rebuild(const RegressArguments& a) {
  const std::filesystem::path build =
      std::filesystem::path(library_of(a, a.plan.arithmetics.front())).parent_path();
  if (std::error_code none; !std::filesystem::exists(build / "CMakeCache.txt", none))
    return Error{fmt::format("--rebuild: {} is no build tree; call the capsoc of one",
                             build.empty() ? "." : build.string())};
  std::string line = "cmake --build " + shell_word(build.string()) + " --target";
  for (Arithmetic arithmetic : a.plan.arithmetics)
    line += fmt::format(" capsoc_rtl_{}_fast", regress::name_of(arithmetic));
  const auto end = workers::run_command(line + " 2>&1", {});
  if (!end) return Error{end.error()};
  if (end.value().code == 0) return std::nullopt;
  host::say("{}", messages_of(end.value().output));
  return Error{"--rebuild: the RTL does not build; what the tools say of it is above"};
}

std::optional<Error> prepare(RegressArguments& a) {
  regress::Plan& plan = a.plan;
  if (a.arithmetic != "paper") plan.arithmetics.push_back(Arithmetic::precise);
  if (a.arithmetic != "precise") plan.arithmetics.push_back(Arithmetic::paper);
  if (a.rebuild && !(a.library.empty() && plan.coverage_directory.empty()))
    return Error{"--rebuild makes its own libraries: leave --rtl-library and --coverage out"};
  if (a.iteration_clocks != 1) {
    if (a.arithmetic != "paper")
      return Error{"--iteration-clocks is a parameter of paper: give --arithmetic paper, too"};
    if (a.rebuild || !plan.coverage_directory.empty())
      return Error{"--iteration-clocks 2 has one library: leave --rebuild and --coverage out"};
    plan.tick *= static_cast<unsigned>(a.iteration_clocks);
  }
  if (a.rebuild) {
    plan.command_options = "--rebuild";
    if (auto error = rebuild(a)) return error;
  }
  if (!a.library.empty() && plan.arithmetics.size() > 1)
    return Error{"--rtl-library holds one arithmetic: give --arithmetic precise or paper, too"};
  if (!a.library.empty()) plan.command_options = "--rtl-library " + shell_word(a.library);
  if (a.iteration_clocks != 1) {
    if (!plan.command_options.empty()) plan.command_options += " ";
    plan.command_options += fmt::format("--iteration-clocks {}", a.iteration_clocks);
  }
  for (const std::string& directory : {plan.coverage_directory, plan.waves_directory})
    if (auto error = make_directory(directory)) return error;
  return check_files(a);
}

/// Opens each arithmetic's library once; instances share nothing but its code.
std::optional<Error> open_libraries(RegressArguments& a) {
  std::vector<std::pair<Arithmetic, rtl::RtlLibrary::Handle>> libraries;
  for (Arithmetic arithmetic : a.plan.arithmetics) {
    const std::string file = library_of(a, arithmetic);
    auto library =
        rtl::RtlLibrary::open(file, options_of(a, arithmetic), rtl::RtlLibrary::Use::at_its_pins);
    if (!library) return Error{library.error()};
    if (library.value()->api().inside == nullptr && !a.plan.coverage_directory.empty())
      return Error{file +
                   ": shows its pins alone, so there is no --coverage of it; leave that out"};
    a.plan.subjects.push_back(regress::subject_of(arithmetic, library.value()));
    libraries.emplace_back(arithmetic, library.value());
  }
  a.plan.compare = [libraries,
                    a](Arithmetic arithmetic) -> Result<std::unique_ptr<regress::Comparison>> {
    for (const auto& [which, library] : libraries)
      if (which == arithmetic) return regress::compare_with_rtl(options_of(a, arithmetic), library);
    return Error{"no library for this arithmetic"};
  };
  return std::nullopt;
}

bool has_coverage(const regress::Run& run) {
  return run.done && !(run.finding && run.finding->kind == regress::Finding::Kind::no_result);
}

/// The coverage files of the runs become one file for each arithmetic.
Result<std::vector<regress::RtlCoverage>> merge(const RegressArguments& a,
                                                const regress::Outcome& outcome) {
  std::vector<regress::RtlCoverage> result;
  if (a.plan.coverage_directory.empty()) return result;
  const auto exceptions = regress::CoverageExceptions::read(a.exceptions);
  if (!exceptions) return Error{exceptions.error()};
  for (Arithmetic arithmetic : a.plan.arithmetics) {
    std::vector<std::string> files;
    for (const regress::Run& run : outcome.runs)
      if (run.arithmetic == arithmetic && has_coverage(run)) files.push_back(run.coverage_file);
    auto merged = regress::merge_coverage(regress::name_of(arithmetic), files,
                                          merged_coverage(a, arithmetic), exceptions.value());
    if (!merged) return Error{merged.error()};
    result.push_back(std::move(merged.value()));
  }
  return result;
}

bool covered(const std::vector<regress::RtlCoverage>& all) {
  for (const regress::RtlCoverage& rtl : all)
    for (const regress::RtlCoverage::Kind& kind : rtl.kinds)
      if (kind.percent() < (kind.name == "line" ? least_line_percent : least_toggle_percent))
        return false;
  return true;
}

/// No run's own coverage file stays, not of one that was ended either.
void remove_coverage(const regress::Outcome& outcome) {
  for (const regress::Run& run : outcome.runs)
    if (!run.coverage_file.empty()) std::remove(run.coverage_file.c_str());
}

/// That gives the same result; the number of threads does not change it.
std::string command_of(const RegressArguments& a) {
  std::string text = fmt::format(
      "capsoc regress --arithmetic {} --seeds {} --first-seed {} --samples {} --accesses {}",
      a.arithmetic, a.plan.seeds, a.plan.first_seed, a.plan.samples, a.plan.accesses);
  for (const std::string& scenario : a.plan.scenarios) text += " --scenario " + scenario;
  if (!a.plan.coverage_directory.empty())
    text += " --coverage " + shell_word(a.plan.coverage_directory);
  return a.plan.command_options.empty() ? text : text + " " + a.plan.command_options;
}

/// false: something was lost, and it is said what.
bool write_files(const RegressArguments& a, const regress::Outcome& outcome,
                 const std::vector<regress::RtlCoverage>& rtl) {
  std::vector<host::TextFile> files;
  nlohmann::ordered_json result = regress::to_json(a.plan, outcome, rtl);
  result["versions"] = run::versions();
  result["command"] = command_of(a);
  if (!a.json.empty()) files.push_back({a.json, run::to_text(result)});
  if (!a.html.empty()) files.push_back({a.html, report::page_of({{"", std::move(result)}})});
  if (!a.junit.empty()) files.push_back({a.junit, regress::to_junit(outcome)});
  bool whole = true;
  for (const host::TextFile& file : files)
    if (auto error = host::write_whole(file.path, file.text)) {
      refuse(error->text);
      whole = false;
    }
  return whole;
}

int exit_code_of(const regress::Outcome& outcome, const std::vector<regress::RtlCoverage>& rtl,
                 bool whole) {
  if (const regress::Run* run = outcome.first_failure())
    return run->finding->kind == regress::Finding::Kind::difference ? run::exit_code::diverged
                                                                    : run::exit_code::failed;
  if (!outcome.complete()) return run::exit_code::signal_base + host::noted_signal();
  if (!covered(rtl)) return run::exit_code::failed;
  return whole ? run::exit_code::pass : run::exit_code::lost;
}

int regress_command(RegressArguments& a) {
  if (a.list) {
    list_scenarios();
    return run::exit_code::pass;
  }
  if (auto error = prepare(a)) return refuse(error->text);
  if (auto error = open_libraries(a)) return refuse(error->text);
  const auto begin = std::chrono::steady_clock::now();
  // Asked for a report on the way: the files as they are now, and the text next to the progress.
  const auto outcome = regress::run_campaign(a.plan, [&a](const regress::Outcome& partial) {
    host::say("\n{}", regress::to_text(a.plan, partial, {}));
    write_files(a, partial, {});
  });
  if (!outcome) return refuse(outcome.error());
  const auto rtl = merge(a, outcome.value());
  remove_coverage(outcome.value());
  if (!rtl) return refuse(rtl.error());
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  host::print("{}", regress::to_text(a.plan, outcome.value(), rtl.value()));
  std::fflush(stdout);
  host::say("{:.1f} s\n", wall.count());
  const bool whole = write_files(a, outcome.value(), rtl.value());
  return exit_code_of(outcome.value(), rtl.value(), whole);
}

}  // namespace

void add_regress(CLI::App& app, int& code) {
  auto a = std::make_shared<RegressArguments>();
  CLI::App* command = app.add_subcommand(
      "regress", "Compare the RTL of the coprocessor with its model; exit 4: they differ");
  a->plan.seeds = 4;
  a->plan.samples = 1000000;
  a->plan.accesses = 100000;
  a->plan.jobs = std::max(1u, std::thread::hardware_concurrency());
  command->add_option("--arithmetic", a->arithmetic, "Which of them")
      ->check(CLI::IsMember({"precise", "paper", "both"}))
      ->capture_default_str();
  command
      ->add_option("--iteration-clocks", a->iteration_clocks,
                   "Of paper: clocks of an iteration of the arctangent, 1 or 2")
      ->transform(whole_number(1, 2))
      ->capture_default_str();
  command->add_option("--seeds", a->plan.seeds, "How many seeds the amounts are spread over")
      ->transform(whole_number(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--first-seed", a->plan.first_seed, "The first of them")
      ->transform(whole_number(0, INT64_MAX))
      ->capture_default_str();
  command->add_option("--samples", a->plan.samples, "Random samples of each arithmetic")
      ->transform(whole_number(0, most_random))
      ->capture_default_str();
  command->add_option("--accesses", a->plan.accesses, "Random bus accesses of each arithmetic")
      ->transform(whole_number(0, most_random))
      ->capture_default_str();
  command->add_option("--jobs", a->plan.jobs, "Runs at once; the results do not depend on it")
      ->transform(whole_number(1, 1024));
  command
      ->add_option("--time-limit", a->plan.seconds,
                   "Seconds that one run may take (default: 300, and 0.02 for each of its samples "
                   "and accesses); one that is not done then has failed")
      ->check(CLI::PositiveNumber)
      ->type_name("S");
  command->add_option("--scenario", a->plan.scenarios, "Only these; --list names them")
      ->type_name("NAME");
  command->add_flag("--list", a->list, "List the scenarios");
  command->add_option("--rtl-library", a->library, "Another Verilated coprocessor")
      ->type_name("FILE.so");
  command->add_flag("--rebuild", a->rebuild,
                    "First build the RTL of the tree as it is, in seconds: not to run fast");
  command->add_option("--junit", a->junit, "Write the result as JUnit XML")->type_name("FILE.xml");
  command->add_option("--json", a->json, "Write the result as JSON")->type_name("FILE.json");
  command->add_option("--html", a->html, "Write a report with figures that a browser shows offline")
      ->type_name("FILE");
  command
      ->add_option("--waves", a->plan.waves_directory,
                   "Waves of every difference, both sides, and a save file for GTKWave")
      ->type_name("DIRECTORY");
  command
      ->add_option("--coverage", a->plan.coverage_directory,
                   "Measure line and toggle coverage of the RTL; files for verilator_coverage")
      ->type_name("DIRECTORY");
  command->add_option("--coverage-exceptions", a->exceptions, "Points that cannot be reached")
      ->type_name("FILE")
      ->capture_default_str();
  command->callback([a, &code] { code = regress_command(*a); });
}

}  // namespace capsoc::cli
