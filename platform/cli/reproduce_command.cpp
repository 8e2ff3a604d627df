// capsoc reproduce: both papers' tables, row by row, beside what this implementation finds.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/table_output.h"
#include "host/places.h"
#include "reproduce/reproduce.h"
#include "run/results.h"

namespace capsoc::cli {

namespace {

int reproduce_command(TableOutput& output) {
  if (output.listed()) return run::exit_code::pass;
  const std::string traces = host::data_path("traces");
  std::vector<host::FileUse> inputs;
  for (const char* trace : reproduce::needed_traces) {
    const std::string path = traces + "/" + trace;
    if (std::error_code ignored; !std::filesystem::exists(path, ignored))
      return refuse(
          fmt::format("{}: there is no such trace; keep the folder traces/ beside capsoc", path));
    inputs.push_back({host::FileUse::Kind::input, "the trace", path});
  }
  if (auto error = output.check(inputs)) return refuse(error->text);
  std::vector<DataTable> tables;
  const int unexpected =
      reproduce::reproduce_tables(output.text(), traces, output.chosen(), &tables);
  return output.finish(tables, "capsoc reproduce",
                       unexpected == 0 ? run::exit_code::pass : run::exit_code::failed);
}

}  // namespace

void add_reproduce(CLI::App& app, int& code) {
  auto output = std::make_shared<TableOutput>();
  CLI::App* command =
      app.add_subcommand("reproduce", "Print every row of both papers' tables beside our figures");
  output->add_to(*command, reproduce::table_names());
  command->callback([output, &code] { code = reproduce_command(*output); });
}

}  // namespace capsoc::cli
