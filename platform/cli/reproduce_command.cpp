// capsoc reproduce: the SoC paper's tables, row by row, beside what this implementation finds.
#include <iostream>

#include "cli/commands.h"
#include "reproduce/reproduce.h"

namespace capsoc::cli {

void add_reproduce(CLI::App& app, int& code) {
  app.add_subcommand("reproduce", "Print every row of the SoC paper's tables beside our figures")
      ->callback([&code] { code = reproduce::reproduce_tables(std::cout); });
}

}  // namespace capsoc::cli
