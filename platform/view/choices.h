// What a page can choose for a new run: a story, a program, the arithmetic.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "service/message.h"
#include "session/run_settings.h"
#include "view/story.h"

namespace capsoc::view {

class Choices {
 public:
  /// A run as it was chosen.
  struct Chosen {
    const Story* story = nullptr;  ///< null: none
    Json settings;                 ///< for RunSession::renew()
    Json shown;                    ///< of the pages: {"story", "program", "arithmetic"}, by name
  };

  /// `settings`: of the command line, without a story. Programs are the run's own, those in its
  /// folder, and those that come with capsoc. A folder is looked at here and never again.
  explicit Choices(const run::RunSettings& settings);

  /// The first run, with a story or null.
  Chosen first(const Story* story) const;
  /// What {"story", "program", "arithmetic"} says. A story "" is none, an arithmetic "" is that of
  /// the command line and the story. An Error names what is there.
  Result<Chosen> choose(const Json& command) const;
  /// For the pages: {"stories": [{"name", "title"}], "programs": [names], "arithmetics": [names]}.
  Json shown() const;

 private:
  struct Program {
    std::string name, path;
  };

  void add(const std::string& path, const std::string& name);
  void add_folder(const std::string& folder, bool has_ending);
  Json settings_with(const Story* story) const;
  Chosen chosen(const Story* story, const Program& program, const std::string& arithmetic) const;

  Json base_;                       // settings
  std::vector<std::string> fixed_;  // paths of those that the user gave, before those of a story
  std::string elf_path_, arithmetic_path_;
  std::vector<Program> programs_;  // the run's own first
  std::vector<std::string> arithmetics_;
};

}  // namespace capsoc::view
