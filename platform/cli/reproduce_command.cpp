// capsoc reproduce: both papers' tables, row by row, beside what this implementation finds.
#include <iostream>

#include "cli/commands.h"
#include "reproduce/reproduce.h"
#include "run/results.h"
#include "run/run_settings.h"

namespace capsoc::cli {

void add_reproduce(CLI::App& app, int& code) {
  app.add_subcommand("reproduce", "Print every row of both papers' tables beside our figures")
      ->callback([&code] {
        const std::string traces = run::program_folder() + "/traces";
        code = reproduce::reproduce_tables(std::cout, traces) == 0 ? run::exit_code::pass
                                                                   : run::exit_code::failed;
      });
}

}  // namespace capsoc::cli
