// capsoc fit: identifies a sensor's parameters from a trace, without a simulation.
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "fit/certainty_tables.h"
#include "fit/fit.h"
#include "fit/report.h"
#include "fit/tables.h"
#include "host/files.h"
#include "run/results.h"

namespace capsoc::cli {
namespace {

struct FitArguments {
  std::string trace;
  bool tables = false;
  std::string table;  ///< one of them
  fit::FitOptions options;
  std::string method = "ml";
  int iterations = 0;  ///< 0: the method's own
  std::string json = "calibration.json";
  std::string header = "calibration.h";
  std::string convergence;
  std::string command = "capsoc fit";  ///< that gives the same fit
};

int refuse(int code, const std::string& text) {
  fmt::print(stderr, "capsoc: {}\n", text);
  return code;
}

/// What the method names on the command line mean.
void choose_method(FitArguments& arguments) {
  csfn::IdentifyOptions& identify = arguments.options.identify;
  arguments.options.all_methods = arguments.method == "all";
  identify.method = csfn::method_from(arguments.method).value_or(csfn::Method::distances);
  if (arguments.iterations != 0) {
    identify.adam.iterations = arguments.iterations;
    identify.levenberg_marquardt.iterations = arguments.iterations;
  }
  identify.trace = !arguments.convergence.empty();
}

int print_tables(const FitArguments& arguments) {
  constexpr int coverage_records = 200, drawn_records = 500;
  const auto wanted = [&](const char* name) { return arguments.tables || arguments.table == name; };
  int missed = 0;
  if (wanted("methods")) missed += fit::print_tables(std::cout);
  if (wanted("coverage")) missed += fit::print_coverage(std::cout, coverage_records);
  if (wanted("drawn")) missed += fit::print_drawn(std::cout, drawn_records);
  return missed == 0 ? run::exit_code::pass : run::exit_code::failed;
}

int fit_command(FitArguments& arguments) {
  if (arguments.tables || !arguments.table.empty()) return print_tables(arguments);
  if (arguments.trace.empty())
    return refuse(run::exit_code::usage, "fit needs a TRACE, --tables or --table; try --help");
  choose_method(arguments);
  for (const std::string& place : {arguments.json, arguments.header, arguments.convergence})
    if (!place.empty())
      if (auto error = host::check_writable(place))
        return refuse(run::exit_code::usage, error->text);

  const auto fitted = fit::fit(arguments.trace, arguments.options);
  if (!fitted) return refuse(run::exit_code::usage, fitted.error());
  const fit::Fit& fit = fitted.value();
  if (!fit.rejection.empty())
    return refuse(run::exit_code::rejected, fmt::format("{}: {}", arguments.trace, fit.rejection));

  fmt::print("{}", fit::to_table(fit));
  std::vector<host::TextFile> files = {
      {arguments.json,
       fit::to_json(fit, run::versions(), arguments.command + " " + arguments.trace).dump(2) +
           "\n"},
      {arguments.header, fit::to_header(fit)}};
  if (!arguments.convergence.empty())
    files.push_back({arguments.convergence, fit::to_convergence(fit)});
  if (auto error = host::write_together(files)) return refuse(run::exit_code::usage, error->text);
  for (const host::TextFile& file : files) fmt::print("wrote        {}\n", file.path);
  return run::exit_code::pass;
}

}  // namespace

void add_fit(CLI::App& app, int& code) {
  auto arguments = std::make_shared<FitArguments>();
  CLI::App* fit = app.add_subcommand(
      "fit", "Identify a sensor's parameters from a trace; writes calibration.json and .h");
  fit->add_option("trace", arguments->trace, "Sensor description (TOML) or recording (CSV)")
      ->type_name("TRACE");
  fit->add_flag("--tables", arguments->tables,
                "Instead of a trace: print how exact every method is on generated records");
  fit->add_option("--table", arguments->table, "One of them: by method, intervals, drawn records")
      ->check(CLI::IsMember({"methods", "coverage", "drawn"}))
      ->type_name("methods|coverage|drawn");
  // Options that change the result are part of the command that gives it again.
  std::vector<CLI::Option*> inputs;
  const auto input = [&](CLI::Option* option, const char* type) {
    inputs.push_back(option->type_name(type));
    return option;
  };
  csfn::IdentifyOptions& identify = arguments->options.identify;
  input(fit->add_option(
               "--method", arguments->method,
               "How: ml is the default; adam as the CSFN paper; all: ml, and the others beside it")
            ->check(CLI::IsMember({"ml", "adam", "lm", "heydemann", "taubin", "direct", "all"})),
        "ml|adam|lm|heydemann|taubin|direct|all");
  input(fit->add_option("--harmonics", identify.harmonics.highest,
                        "Highest harmonic to identify (0 and 1: none)")
            ->check(CLI::Range(0, 3)),
        "0..3");
  input(fit->add_option("--batch", identify.adam.batch, "Samples a step of Adam")
            ->check(CLI::Range(int64_t{1}, int64_t{1'000'000'000})),
        "N");
  input(fit->add_option("--rate", identify.adam.rate, "Adam's rate at the start; it decays")
            ->check(CLI::Range(1e-9, 1.0)),
        "X");
  input(fit->add_option("--iterations", arguments->iterations, "Limit of iterations")
            ->check(CLI::Range(1, 1'000'000'000)),
        "N");
  input(fit->add_option("--seed", identify.adam.seed, "Seed of Adam's shuffling"), "N");
  input(fit->add_option("--samples", arguments->options.record.samples,
                        "Take so many samples only (of a trace without an end: 100,000)")
            ->check(CLI::Range(int64_t{1}, int64_t{1'000'000'000})),
        "N");
  input(fit->add_option("--adc-bits", arguments->options.record.adc_bits,
                        "Width of the converter (default: as the trace says)")
            ->check(CLI::Range(12, 32)),
        "N");
  fit->add_option("--json", arguments->json, "Where the calibration goes")
      ->type_name("FILE")
      ->capture_default_str();
  fit->add_option("--header", arguments->header, "Where the words for the firmware go")
      ->type_name("FILE")
      ->capture_default_str();
  fit->add_option("--convergence", arguments->convergence,
                  "Write loss and parameters by iteration (adam, lm)")
      ->type_name("FILE.csv");
  fit->callback([arguments, inputs, &code] {
    for (const CLI::Option* option : inputs)
      if (option->count() > 0)
        arguments->command += fmt::format(" {} {}", option->get_name(), option->as<std::string>());
    code = fit_command(*arguments);
  });
}

}  // namespace capsoc::cli
