// capsoc accuracy: how exact the coprocessor is with sensors and motions beyond the SoC paper's.
#include <memory>

#include "accuracy/accuracy.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/table_output.h"
#include "report/accuracy_table_names.h"

namespace capsoc::cli {
namespace {

int accuracy_command(TableOutput& output) {
  if (output.listed()) return run::exit_code::pass;
  if (auto error = output.check()) return refuse(error->text);
  std::vector<DataTable> tables;
  const int missed = accuracy::print_accuracy(output.text(), output.chosen(), &tables);
  return output.finish(tables, "capsoc accuracy",
                       missed == 0 ? run::exit_code::pass : run::exit_code::failed);
}

}  // namespace

void add_accuracy(CLI::App& app, int& code) {
  auto output = std::make_shared<TableOutput>();
  CLI::App* command = app.add_subcommand(
      "accuracy", "Print angle errors for sensors and motions beyond the paper's");
  output->add_to(*command, {accuracy::table_names.begin(), accuracy::table_names.end()});
  command->callback([output, &code] { code = accuracy_command(*output); });
}

}  // namespace capsoc::cli
