// capsoc reproduce: both papers' tables, row by row, next to what this implementation finds.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/table_output.h"
#include "host/places.h"
#include "reproduce/drawn.h"
#include "reproduce/reproduce.h"
#include "results/results.h"

namespace capsoc::cli {

namespace {

int reproduce_command(TableOutput& output, const std::string& synthesis_file) {
  if (output.listed()) return run::exit_code::pass;
  const std::string traces = host::data_path("traces");
  std::vector<host::FileUse> inputs;
  for (const char* trace : reproduce::needed_traces) {
    const std::string path = traces + "/" + trace;
    if (std::error_code ignored; !std::filesystem::exists(path, ignored))
      return refuse(
          fmt::format("{}: there is no such trace; keep the folder traces/ next to capsoc", path));
    inputs.push_back({host::FileUse::Kind::input, "the trace", path});
  }
  if (!synthesis_file.empty())
    inputs.push_back({host::FileUse::Kind::input, "--synthesis", synthesis_file});
  if (auto error = output.check(inputs)) return refuse(error->text);
  reproduce::Synthesis synthesis;
  if (!synthesis_file.empty()) {
    auto read = reproduce::read_synthesis(synthesis_file);
    if (!read) return refuse(read.error());
    synthesis = std::move(read.value());
  }
  std::vector<DataTable> tables;
  const int unexpected =
      reproduce::reproduce_tables(output.text(), traces, output.chosen(), &tables, synthesis);
  Curves curves;
  if (output.wants_curves()) {
    auto drawn = reproduce::drawn_figures(traces, output.chosen());
    if (!drawn) return refuse(drawn.error());
    curves = std::move(drawn.value());
  }
  return output.finish(tables, "capsoc reproduce",
                       unexpected == 0 ? run::exit_code::pass : run::exit_code::failed, curves);
}

}  // namespace

void add_reproduce(CLI::App& app, int& code) {
  auto output = std::make_shared<TableOutput>();
  auto synthesis = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("reproduce", "Print every row of both papers' tables with our figures");
  output->add_to(*command, reproduce::table_names(), true);
  command
      ->add_option("--synthesis", *synthesis,
                   "Our side of Table 7: what scripts/tool synth --json FILE wrote")
      ->type_name("FILE");
  command->callback([output, synthesis, &code] { code = reproduce_command(*output, *synthesis); });
}

}  // namespace capsoc::cli
