// capsoc regress: the C++ model and the RTL of the coprocessor against each other.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "cli/commands.h"
#include "host/files.h"
#include "regress/report.h"
#include "regress/rtl_comparison.h"
#include "run/results.h"

namespace capsoc::cli {
namespace {

using coprocessor::Arithmetic;

constexpr double least_line_percent = 100, least_toggle_percent = 98;

struct RegressArguments {
  std::string arithmetic = "both";
  regress::Plan plan;
  std::string library, junit, json;
  std::string exceptions = "rtl/verification/coverage_exceptions.txt";
  bool list = false;
};

int refuse(const std::string& text) {
  fmt::print(stderr, "capsoc: {}\n", text);
  return run::exit_code::usage;
}

void list_scenarios() {
  for (const regress::Scenario& scenario : regress::scenarios())
    fmt::print("{:<16} {}\n", scenario.name, scenario.purpose);
}

std::optional<Error> prepare(RegressArguments& a) {
  regress::Plan& plan = a.plan;
  if (a.arithmetic != "paper") plan.arithmetics.push_back(Arithmetic::precise);
  if (a.arithmetic != "precise") plan.arithmetics.push_back(Arithmetic::paper);
  if (!a.library.empty() && plan.arithmetics.size() > 1)
    return Error{"--rtl-library holds one arithmetic: give --arithmetic precise or paper, too"};
  for (const std::string& file : {a.junit, a.json})
    if (!file.empty())
      if (auto error = host::check_writable(file)) return error;
  if (!a.library.empty()) plan.command_options = "--rtl-library " + a.library;
  std::error_code failure;
  if (!plan.coverage_directory.empty() && !std::filesystem::is_directory(plan.coverage_directory) &&
      !std::filesystem::create_directories(plan.coverage_directory, failure))
    return Error{fmt::format("the directory {} cannot be made: {}", plan.coverage_directory,
                             failure.message())};
  return std::nullopt;
}

/// Opens each arithmetic's library once; instances share nothing but its code.
std::optional<Error> open_libraries(RegressArguments& a) {
  std::vector<std::pair<Arithmetic, rtl::RtlLibrary::Handle>> libraries;
  for (Arithmetic arithmetic : a.plan.arithmetics) {
    const bool coverage = !a.plan.coverage_directory.empty();
    const std::string file =
        a.library.empty() ? rtl::RtlLibrary::file_name(arithmetic, coverage) : a.library;
    coprocessor::Options options;
    options.arithmetic = arithmetic;
    auto library = rtl::RtlLibrary::open(file, options);
    if (!library) return Error{library.error()};
    libraries.emplace_back(arithmetic, library.value());
  }
  a.plan.compare =
      [libraries](Arithmetic arithmetic) -> Result<std::unique_ptr<regress::Comparison>> {
    coprocessor::Options options;
    options.arithmetic = arithmetic;
    for (const auto& [which, library] : libraries)
      if (which == arithmetic) return regress::compare_with_rtl(options, library);
    return Error{"no library for this arithmetic"};
  };
  return std::nullopt;
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
      if (run.arithmetic == arithmetic) files.push_back(run.coverage_file);
    const std::string name = regress::name_of(arithmetic);
    auto merged = regress::merge_coverage(
        name, files, a.plan.coverage_directory + "/" + name + ".dat", exceptions.value());
    if (!merged) return Error{merged.error()};
    for (const std::string& file : files) std::remove(file.c_str());
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

int regress_command(RegressArguments& a) {
  if (a.list) {
    list_scenarios();
    return run::exit_code::pass;
  }
  if (auto error = prepare(a)) return refuse(error->text);
  if (auto error = open_libraries(a)) return refuse(error->text);
  const auto begin = std::chrono::steady_clock::now();
  const auto outcome = regress::run_campaign(a.plan);
  if (!outcome) return refuse(outcome.error());
  const auto rtl = merge(a, outcome.value());
  if (!rtl) return refuse(rtl.error());
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  fmt::print("{}", regress::to_text(outcome.value(), rtl.value()));
  std::fflush(stdout);
  fmt::print(stderr, "{:.1f} s\n", wall.count());
  std::vector<host::TextFile> files;
  if (!a.json.empty())
    files.push_back(
        {a.json, regress::to_json(a.plan, outcome.value(), rtl.value()).dump(2) + "\n"});
  if (!a.junit.empty()) files.push_back({a.junit, regress::to_junit(outcome.value())});
  for (const host::TextFile& file : files)
    if (auto error = host::write_whole(file.path, file.text)) return refuse(error->text);
  if (outcome.value().first_difference() != nullptr) return run::exit_code::diverged;
  return covered(rtl.value()) ? run::exit_code::pass : run::exit_code::failed;
}

}  // namespace

void add_regress(CLI::App& app, int& code) {
  auto a = std::make_shared<RegressArguments>();
  CLI::App* command = app.add_subcommand(
      "regress", "Hold the RTL of the coprocessor against its model; exit 4: they differ");
  a->plan.seeds = 4;
  a->plan.samples = 1000000;
  a->plan.accesses = 100000;
  a->plan.jobs = std::max(1u, std::thread::hardware_concurrency());
  command->add_option("--arithmetic", a->arithmetic, "Which of them")
      ->check(CLI::IsMember({"precise", "paper", "both"}))
      ->capture_default_str();
  command->add_option("--seeds", a->plan.seeds, "How many seeds the amounts are spread over")
      ->check(CLI::Range(uint64_t{1}, uint64_t{1000000}))
      ->capture_default_str();
  command->add_option("--first-seed", a->plan.first_seed, "The first of them")
      ->capture_default_str();
  command->add_option("--samples", a->plan.samples, "Random samples of each arithmetic")
      ->capture_default_str();
  command->add_option("--accesses", a->plan.accesses, "Random bus accesses of each arithmetic")
      ->capture_default_str();
  command->add_option("--jobs", a->plan.jobs, "Threads; the results do not depend on it")
      ->check(CLI::Range(1u, 1024u));
  command->add_option("--scenario", a->plan.scenarios, "Only these; --list names them")
      ->type_name("NAME");
  command->add_flag("--list", a->list, "List the scenarios");
  command->add_option("--rtl-library", a->library, "Another Verilated coprocessor")
      ->type_name("FILE.so");
  command->add_option("--junit", a->junit, "Write the result as JUnit XML")->type_name("FILE.xml");
  command->add_option("--json", a->json, "Write the result as JSON")->type_name("FILE.json");
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
