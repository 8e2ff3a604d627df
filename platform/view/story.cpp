#include "view/story.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>

#include "base/nearest.h"
#include "base/printable.h"
#include "base/toml.h"

namespace capsoc::view {

extern const std::string_view page_stories;  // embedded at build time

namespace {

Json json_of(const toml::table& table) {
  std::ostringstream text;
  text << toml::json_formatter(table);
  return Json::parse(text.str());
}

/// One line of the page: the file breaks its lines where they are full.
std::string joined(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

Story story_of(const toml::table& table) {
  Story story;
  story.name = table["name"].value_or(std::string());
  story.title = table["title"].value_or(std::string());
  story.speed = table["speed"].value_or(1.0);
  if (const auto* const settings = table["settings"].as_table())
    for (const auto& [key, value] : *settings)
      story.settings.emplace_back(std::string(key), value.value_or(std::string()));
  if (const auto* const steps = table["step"].as_array())
    for (const auto& each : *steps) {
      const toml::table& step = *each.as_table();
      const auto* const command = step["do"].as_table();
      story.steps.push_back({step["at_s"].value_or(0.0),
                             joined(step["text"].value_or(std::string())),
                             command == nullptr ? Json() : json_of(*command)});
    }
  return story;
}

std::vector<Story> read_stories() {
  std::vector<Story> all;
  const toml::parse_result parsed = toml::parse(page_stories);
  if (!parsed) return all;  // a test reads the file
  if (const auto* const list = parsed.table()["story"].as_array())
    for (const auto& each : *list) all.push_back(story_of(*each.as_table()));
  return all;
}

}  // namespace

const std::vector<Story>& stories() {
  static const std::vector<Story> all = read_stories();
  return all;
}

Result<const Story*> find_story(const std::string& name) {
  std::vector<std::string> names;
  for (const Story& story : stories()) {
    if (story.name == name) return &story;
    names.push_back(story.name);
  }
  return Error{fmt::format("there is no story '{}'; did you mean {}?", printable(name, 80),
                           nearest_names(printable(name, 80), names))};
}

StoryCourse::StoryCourse(const Story* story)
    : story_(story), done_(story == nullptr ? 0 : story->steps.size(), false) {}

std::size_t StoryCourse::steps_until(double now_s) const {
  if (story_ == nullptr) return 0;
  const auto after = std::find_if(story_->steps.begin(), story_->steps.end(),
                                  [now_s](const Story::Step& step) { return step.at_s > now_s; });
  return static_cast<std::size_t>(after - story_->steps.begin());
}

std::optional<double> StoryCourse::next_s(double now_s) const {
  const std::size_t next = steps_until(now_s);
  if (story_ == nullptr || next == story_->steps.size()) return std::nullopt;
  return story_->steps[next].at_s;
}

const Story::Step* StoryCourse::reach(double now_s, bool by_running) {
  const std::size_t reached = steps_until(now_s);
  const bool is_new = by_running && reached > reached_;
  reached_ = reached;
  return is_new ? &story_->steps[reached - 1] : nullptr;
}

bool StoryCourse::is_due(const Story::Step& step) {
  if (step.command.is_null()) return false;
  const auto number = static_cast<std::size_t>(&step - story_->steps.data());
  const bool was_done = done_[number];
  done_[number] = true;
  return !was_done;
}

void StoryCourse::forget_after(double now_s) {
  for (std::size_t i = steps_until(now_s); i < done_.size(); ++i) done_[i] = false;
}

Json StoryCourse::shown() const {
  if (story_ == nullptr) return nullptr;
  return {{"title", story_->title},
          {"text", reached_ == 0 ? "" : story_->steps[reached_ - 1].text},
          {"step", reached_},
          {"steps", story_->steps.size()}};
}

}  // namespace capsoc::view
