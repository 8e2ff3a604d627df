// Guided runs for the page: text at some of a run's times (stories.toml).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "service/message.h"

namespace capsoc::view {

using service::Json;

struct Story {
  struct Step {
    double at_s = 0;  ///< simulated time at which the run stops and the text appears
    std::string text;
    Json command;  ///< of the page, carried out there; null: none
  };

  std::string name, title;
  double speed = 1;  ///< simulated seconds a second of the host
  std::vector<std::pair<std::string, std::string>> settings;  ///< of the run
  std::vector<Step> steps;                                    ///< in the order of time
};

/// All of stories.toml.
const std::vector<Story>& stories();
/// An Error names those that exist.
Result<const Story*> find_story(const std::string& name);

/// Where a run is in its story.
class StoryCourse {
 public:
  /// Null: the run has no story.
  explicit StoryCourse(const Story* story);

  /// Of the first step after a time; nothing: there is none.
  std::optional<double> next_s(double now_s) const;
  /// The run stands at this time. The step that it has just reached by running, whose text is to
  /// be read; null: none.
  const Story::Step* reach(double now_s, bool by_running);
  /// Whether a step's command is to be carried out: true once, until forget_after().
  bool is_due(const Story::Step& step);
  /// Another future begins at this time: the commands of later steps are due again.
  void forget_after(double now_s);
  /// For the pages: {"title", "text", "step", "steps"}; null: there is no story.
  Json shown() const;

 private:
  std::size_t steps_until(double now_s) const;

  const Story* story_;
  std::size_t reached_ = 0;  ///< steps
  std::vector<bool> done_;
};

}  // namespace capsoc::view
