// capsoc fit: identifies a sensor's parameters from a trace, without a simulation.
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "base/number.h"
#include "base/printable.h"
#include "base/shell.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/whole_number.h"
#include "fit/certainty_tables.h"
#include "fit/drawn.h"
#include "fit/fit.h"
#include "fit/report.h"
#include "fit/tables.h"
#include "host/console.h"
#include "host/file_uses.h"
#include "host/files.h"
#include "report/page.h"
#include "results/results.h"
#include "sensor/load.h"

namespace capsoc::cli {
namespace {

struct FitArguments {
  std::string trace;
  bool tables = false;
  std::string table;  ///< one of them
  uint64_t table_seed = fit::seed;
  int table_records = 0;  ///< 0: the table's own
  fit::FitOptions options;
  std::string method = "ml";
  int iterations = 0;              ///< 0: the method's own
  std::string json, header, html;  ///< all empty: none was named
  bool curves = false;
  std::string convergence;
  std::string full_scale, zero, scale;   ///< as they were given
  std::vector<std::string> assignments;  ///< sensor.KEY=VALUE
  std::string command = "capsoc fit";    ///< that gives the same fit
};

/// What the method names on the command line mean.
void choose_method(FitArguments& arguments) {
  identification::IdentifyOptions& identify = arguments.options.identify;
  arguments.options.all_methods = arguments.method == "all";
  identify.method =
      identification::method_from(arguments.method).value_or(identification::Method::distances);
  if (arguments.iterations != 0) {
    identify.adam.iterations = arguments.iterations;
    identify.levenberg_marquardt.iterations = arguments.iterations;
  }
  identify.trace = !arguments.convergence.empty() || !arguments.html.empty() || arguments.curves;
}

int print_tables(const FitArguments& arguments) {
  constexpr int coverage_records = 200, drawn_records = 500, allowance_sensors = 300,
                bound_records = 2000;
  const auto wanted = [&](const char* name) { return arguments.tables || arguments.table == name; };
  int missed = 0;
  if (wanted("methods")) missed += fit::print_tables(std::cout);
  if (arguments.table == "peers") missed += fit::print_peers(std::cout);  // its times differ
  const auto records = [&](int own) {
    return arguments.table_records > 0 ? arguments.table_records : own;
  };
  if (wanted("coverage"))
    missed += fit::print_coverage(std::cout, records(coverage_records), arguments.table_seed);
  if (arguments.table == "bound")  // of many records
    missed += fit::print_bounds(std::cout, records(bound_records), arguments.table_seed);
  if (wanted("drawn")) {
    missed += fit::print_drawn(std::cout, drawn_records);
    missed += fit::print_allowance(std::cout, allowance_sensors);
  }
  return missed == 0 ? run::exit_code::pass : run::exit_code::failed;
}

/// No output is the trace or another output, and all of them can be written.
std::optional<Error> check_files(const FitArguments& arguments) {
  using Kind = host::FileUse::Kind;
  std::vector<host::FileUse> uses = {{Kind::output, "--json", arguments.json},
                                     {Kind::output, "--header", arguments.header},
                                     {Kind::output, "--html", arguments.html},
                                     {Kind::output, "--convergence", arguments.convergence}};
  for (const std::string& file : sensor::files_of(arguments.trace))
    uses.insert(uses.begin(), {Kind::input, "TRACE", file});
  if (auto error = host::check_uses(uses)) return error;
  for (const host::FileUse& use : uses)
    if (use.kind == Kind::output && !use.path.empty())
      if (auto error = host::check_writable(use.path)) return error;
  return std::nullopt;
}

/// The keys of the description that were set.
std::optional<Error> take_assignments(FitArguments& arguments) {
  for (const std::string& assignment : arguments.assignments) {
    const std::string prefix = "sensor.";
    const auto equals = assignment.find('=');
    if (assignment.rfind(prefix, 0) != 0 || equals == std::string::npos)
      return Error{fmt::format("-C {}: write sensor.KEY=VALUE, for instance -C sensor.a1=0.5",
                               printable(assignment))};
    const std::string key = assignment.substr(prefix.size(), equals - prefix.size());
    const std::string value = assignment.substr(equals + 1);
    // As settings of capsoc run, they are no keys of a description.
    if (key == "columns")
      arguments.options.record.recording.columns = value;
    else if (key == "full_scale" || key == "zero" || key == "scale")
      (key == "zero"    ? arguments.zero
       : key == "scale" ? arguments.scale
                        : arguments.full_scale) = value;
    else
      arguments.options.record.keys.push_back({key, value, "-C " + assignment});
    arguments.command += " -C " + shell_word(assignment);
  }
  return std::nullopt;
}

/// The unit of a recording's values.
std::optional<Error> take_scale(FitArguments& arguments) {
  sensor::RecordingOptions& recording = arguments.options.record.recording;
  for (const auto& [name, text, value] :
       {std::make_tuple("--full-scale", &arguments.full_scale, &recording.full_scale),
        std::make_tuple("--zero", &arguments.zero, &recording.zero)}) {
    if (text->empty()) continue;
    *value = finite_number(*text);
    if (!*value)
      return Error{fmt::format("{} cannot be '{}'; give a number", name, printable(*text))};
  }
  if (!arguments.scale.empty() && arguments.scale != "auto")
    return Error{
        fmt::format("--scale cannot be '{}'; give auto, or a unit by --full-scale and --zero",
                    printable(arguments.scale))};
  recording.automatic_scale = arguments.scale == "auto";
  return std::nullopt;
}

/// Writes what was asked for, all or nothing, and prints what there is to say.
int report(const FitArguments& arguments, const fit::Fit& fit) {
  std::vector<host::TextFile> files;
  const std::string command = arguments.command + " " + arguments.trace;
  nlohmann::ordered_json result = fit::to_json(fit, run::versions(), command);
  if (!arguments.html.empty() || arguments.curves) result["curves"] = to_json(fit::curves_of(fit));
  if (!arguments.json.empty()) files.push_back({arguments.json, run::to_text(result)});
  if (!arguments.html.empty())
    files.push_back({arguments.html, report::page_of({{"", std::move(result)}})});
  if (!arguments.header.empty()) files.push_back({arguments.header, fit::to_header(fit)});
  if (!arguments.convergence.empty())
    files.push_back({arguments.convergence, fit::to_convergence(fit)});
  const auto error = host::write_together(files);
  host::print("{}", fit::to_table(fit));
  if (error) return refuse(error->text, run::exit_code::lost);
  for (const host::TextFile& file : files) host::print("wrote        {}\n", file.path);
  return run::exit_code::pass;
}

int fit_command(FitArguments& arguments) {
  if (arguments.tables || !arguments.table.empty()) return print_tables(arguments);
  if (arguments.trace.empty()) return refuse("fit needs a TRACE, --tables or --table; try --help");
  choose_method(arguments);
  if (auto error = take_assignments(arguments)) return refuse(error->text);
  if (auto error = take_scale(arguments)) return refuse(error->text);
  if (auto error = check_files(arguments)) return refuse(error->text);
  const auto fitted = fit::fit(arguments.trace, arguments.options);
  if (!fitted) return refuse(fitted.error());
  if (const std::string& reason = fitted.value().rejection; !reason.empty())
    return refuse(fmt::format("{}: {}", arguments.trace, reason), run::exit_code::rejected);
  for (const std::string& sentence : fitted.value().record.warnings)
    host::say("warning: {}\n", sentence);
  return report(arguments, fitted.value());
}

}  // namespace

void add_fit(CLI::App& app, int& code) {
  auto arguments = std::make_shared<FitArguments>();
  CLI::App* fit = app.add_subcommand(
      "fit", "Identify a sensor's parameters from a trace; writes calibration.json and .h");
  fit->add_option("trace", arguments->trace,
                  "Sensor description (TOML) or recording (text, WAV, MAT, SDS; or U.csv,V.csv); "
                  "-: standard input")
      ->type_name("TRACE");
  fit->add_flag("--tables", arguments->tables,
                "Instead of a trace: print how exact every method is on generated records");
  fit->add_option(
         "--table", arguments->table,
         "One of them: by method, how often intervals hold, random records and harmonics; or "
         "the methods that the papers name, with their times; bound: stated bounds over true "
         "errors")
      ->check(CLI::IsMember({"methods", "coverage", "drawn", "peers", "bound"}))
      ->type_name("methods|coverage|drawn|peers|bound");
  fit->add_option("--table-seed", arguments->table_seed,
                  "Seed of the records of --table coverage and bound")
      ->transform(whole_number(0, UINT64_MAX))
      ->type_name("N");
  fit->add_option("--table-records", arguments->table_records,
                  "Records a row of --table coverage and bound (default: 200 and 2,000)")
      ->transform(whole_number(1, 1'000'000))
      ->type_name("N");
  // Options that change the result are part of the command that gives it again.
  std::vector<CLI::Option*> inputs;
  const auto input = [&](CLI::Option* option, const char* type) {
    inputs.push_back(option->type_name(type));
    return option;
  };
  identification::IdentifyOptions& identify = arguments->options.identify;
  input(fit->add_option("--method", arguments->method,
                        "How: ml is the default; adam as the CSFN paper; all: ml, and the others "
                        "for comparison")
            ->check(CLI::IsMember({"ml", "adam", "lm", "heydemann", "taubin", "direct", "all"})),
        "ml|adam|lm|heydemann|taubin|direct|all");
  input(fit->add_option("--harmonics", identify.harmonics.highest,
                        "Highest harmonic to identify (0 and 1: none)")
            ->transform(whole_number(0, 3)),
        "0..3");
  const auto assume = [arguments](const std::string& word) {
    arguments->options.identify.harmonics.assumption =
        word == "speed"       ? identification::Assumption::constant_speed
        : word == "coverage"  ? identification::Assumption::even_coverage
        : word == "symmetric" ? identification::Assumption::symmetric
                              : identification::Assumption::automatic;
  };
  input(fit->add_option_function<std::string>(
               "--assume", assume,
               "What --harmonics may rely on: constant speed in order of time, samples that cover "
               "whole turns evenly, one waveform in both channels")
            ->check(CLI::IsMember({"automatic", "speed", "coverage", "symmetric"})),
        "automatic|speed|coverage|symmetric");
  inputs.push_back(
      fit->add_flag("--use-angle", arguments->options.use_angle,
                    "Learn an error table from the column of true angles, for --parameters")
          ->excludes("--harmonics"));
  input(fit->add_option("--batch", identify.adam.batch, "Samples a step of Adam")
            ->transform(whole_number(1, 1'000'000'000)),
        "N");
  input(fit->add_option("--rate", identify.adam.rate, "Adam's rate at the start; it decays")
            ->check(real_number(1e-9, 1)),
        "X");
  input(fit->add_option("--iterations", arguments->iterations, "Limit of iterations")
            ->transform(whole_number(1, 1'000'000'000)),
        "N");
  input(fit->add_option("--seed", identify.adam.seed, "Seed of Adam's shuffling")
            ->transform(whole_number(0, UINT64_MAX)),
        "N");
  input(fit->add_option("--samples", arguments->options.record.samples,
                        "Take only N samples (of a trace without an end: 100,000)")
            ->transform(whole_number(1, 1'000'000'000)),
        "N");
  input(fit->add_option("--adc-bits", arguments->options.record.adc_bits,
                        "Width of the converter (default: as the trace says)")
            ->transform(whole_number(12, 32)),
        "N");
  input(fit->add_option("--columns", arguments->options.record.recording.columns,
                        "Columns of a recording by name or number from 1 (or U,V, or T,U,V)"),
        "T,U,V,ANGLE");
  input(fit->add_option("--full-scale", arguments->full_scale,
                        "Value of a recording that is full scale (12 bits: 2048)"),
        "X");
  input(fit->add_option("--zero", arguments->zero,
                        "Value of a recording that is zero (12 bits: 2048)"),
        "X");
  input(fit->add_option("--scale", arguments->scale,
                        "Find full scale and zero of a recording by its values"),
        "auto");
  fit->add_option("-C", arguments->assignments, "Set a key of the description")
      ->type_name("sensor.KEY=VALUE")
      ->allow_extra_args(false);
  fit->add_option("--json", arguments->json,
                  "Where the calibration goes (without --header, too: calibration.json)")
      ->type_name("FILE")
      ->check(not_empty());
  fit->add_option("--header", arguments->header,
                  "Where the words for the firmware go (without --json, too: calibration.h)")
      ->type_name("FILE")
      ->check(not_empty());
  fit->add_option("--html", arguments->html,
                  "Write a report with curves that a browser shows offline")
      ->type_name("FILE")
      ->check(not_empty());
  fit->add_flag("--curves", arguments->curves, "Curves in the JSON file, for capsoc report");
  fit->add_option("--convergence", arguments->convergence,
                  "Write loss and parameters by iteration (adam, lm)")
      ->type_name("FILE.csv");
  fit->callback([arguments, inputs, &code] {
    for (const CLI::Option* option : inputs) {
      if (option->count() == 0) continue;
      arguments->command += " " + option->get_name();
      if (option->get_expected_max() > 0)
        arguments->command += " " + shell_word(option->as<std::string>());
    }
    if (arguments->json.empty() && arguments->header.empty() && arguments->html.empty()) {
      arguments->json = "calibration.json";
      arguments->header = "calibration.h";
    }
    code = fit_command(*arguments);
  });
}

}  // namespace capsoc::cli
