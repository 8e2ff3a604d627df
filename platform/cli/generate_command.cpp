// capsoc generate: man pages and completions from the command line's own declarations. For the
// build; --help does not show it.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/command_tree.h"
#include "cli/commands.h"
#include "cli/exit_codes.h"
#include "cli/refuse.h"
#include "host/files.h"
#include "manual/pages.h"
#include "results/results.h"
#include "session/run_settings.h"
#include "version/version.h"

namespace capsoc::cli {
namespace {

std::optional<Error> write(const manual::Page& page, const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder) / page.path;
  std::error_code failure;
  std::filesystem::create_directories(path.parent_path(), failure);
  if (failure)
    return Error{fmt::format("{}: cannot be made ({}); name another folder",
                             path.parent_path().string(), failure.message())};
  return host::write_whole(path.string(), page.text);
}

int generate(CLI::App& app, const std::string& folder) {
  manual::CommandLine line;
  line.version = version();
  line.program = command_tree(app);
  const run::RunSettings settings;
  line.settings = settings.all();
  for (const ExitCodeText& text : exit_codes())
    line.exit_codes.push_back({text.code, text.meaning});
  std::vector<manual::Page> pages = manual_pages(line);
  for (const manual::Page& page :
       {bash_completion(line), zsh_completion(line), fish_completion(line)})
    pages.push_back(page);
  for (const manual::Page& page : pages)
    if (auto error = write(page, folder)) return refuse(error->text);
  return run::exit_code::pass;
}

}  // namespace

void add_generate(CLI::App& app, int& code) {
  auto folder = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("generate", "Write man pages and completions below a folder")->group("");
  command->add_option("folder", *folder, "As share/ of an install tree")
      ->required()
      ->type_name("DIR");
  command->callback([&app, folder, &code] { code = generate(app, *folder); });
}

}  // namespace capsoc::cli
