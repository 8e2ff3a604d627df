// capsoc accuracy: how exact the coprocessor is with sensors and motions beyond the SoC paper's.
#include <iostream>

#include "accuracy/accuracy.h"
#include "cli/commands.h"

namespace capsoc::cli {

void add_accuracy(CLI::App& app, int& code) {
  app.add_subcommand("accuracy", "Print angle errors for sensors and motions beyond the paper's")
      ->callback([&code] { code = accuracy::print_accuracy(std::cout) == 0 ? 0 : 1; });
}

}  // namespace capsoc::cli
