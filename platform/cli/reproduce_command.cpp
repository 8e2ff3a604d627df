// capsoc reproduce: both papers' tables, row by row, beside what this implementation finds.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "cli/commands.h"
#include "cli/refuse.h"
#include "host/places.h"
#include "reproduce/reproduce.h"
#include "run/results.h"

namespace capsoc::cli {

void add_reproduce(CLI::App& app, int& code) {
  app.add_subcommand("reproduce", "Print every row of both papers' tables beside our figures")
      ->callback([&code] {
        const std::string traces = host::data_path("traces");
        for (const char* trace : reproduce::needed_traces)
          if (std::error_code ignored; !std::filesystem::exists(traces + "/" + trace, ignored)) {
            code = refuse(
                fmt::format("{}/{}: there is no such trace; keep the folder traces/ beside capsoc",
                            traces, trace));
            return;
          }
        code = reproduce::reproduce_tables(std::cout, traces) == 0 ? run::exit_code::pass
                                                                   : run::exit_code::failed;
      });
}

}  // namespace capsoc::cli
