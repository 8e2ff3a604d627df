// Man pages and completions from a command line's declarations.
#pragma once

#include <string>
#include <vector>

#include "manual/command.h"

namespace capsoc::manual {

/// A file and where it goes below share/ of an install tree.
struct Page {
  std::string path, text;
};

/// man/man1/capsoc.1 and one page for each subcommand, in man(7).
std::vector<Page> manual_pages(const CommandLine& line);

/// The completion of bash, which needs no bash-completion package.
Page bash_completion(const CommandLine& line);
Page zsh_completion(const CommandLine& line);
Page fish_completion(const CommandLine& line);

}  // namespace capsoc::manual
