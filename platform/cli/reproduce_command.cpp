// capsoc reproduce: both papers' tables, row by row, beside what this implementation finds.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "cli/commands.h"
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
            fmt::print(stderr,
                       "capsoc: {}/{}: there is no such trace; keep the folder traces/ beside "
                       "capsoc\n",
                       traces, trace);
            code = run::exit_code::usage;
            return;
          }
        code = reproduce::reproduce_tables(std::cout, traces) == 0 ? run::exit_code::pass
                                                                   : run::exit_code::failed;
      });
}

}  // namespace capsoc::cli
