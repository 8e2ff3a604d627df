#include "view/choices.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/nearest.h"
#include "base/printable.h"
#include "host/places.h"
#include "service/run_session.h"

namespace capsoc::view {
namespace {

constexpr const char* ending = ".elf";
constexpr std::size_t most_programs = 1000;

/// Null: it is no text. Missing: "".
const std::string* text_in(const Json& command, const char* name) {
  static const std::string none;
  const auto found = command.find(name);
  return found == command.end() ? &none : found->get_ptr<const std::string*>();
}

}  // namespace

Choices::Choices(const run::RunSettings& settings)
    : base_(service::RunSession::settings_of(settings)),
      elf_path_(settings.firmware.elf.about().path),
      arithmetic_path_(settings.coprocessor.arithmetic.about().path),
      arithmetics_(settings.coprocessor.arithmetic.about().choices) {
  for (const Setting& setting : settings.all())
    if (setting.source == SettingSource::command_line) fixed_.push_back(setting.path);
  const std::filesystem::path own(settings.firmware.elf());
  const std::string coming = host::data_path("firmware");
  std::error_code ignored;
  const bool comes_with_it = std::filesystem::equivalent(own.parent_path(), coming, ignored);
  add(own.string(), comes_with_it ? own.stem().string() : own.filename().string());
  add_folder(coming, false);
  if (!comes_with_it && own.has_parent_path()) add_folder(own.parent_path().string(), true);
  if (!own.has_parent_path()) add_folder(".", true);
}

void Choices::add(const std::string& path, const std::string& name) {
  const bool is_there = std::any_of(programs_.begin(), programs_.end(), [&](const Program& other) {
    return other.name == name || other.path == path;
  });
  if (!is_there && programs_.size() < most_programs) programs_.push_back({name, path});
}

/// Its programs by name, with or without their ending.
void Choices::add_folder(const std::string& folder, bool has_ending) {
  for (const std::filesystem::path& file : host::files_in(folder, ending))
    add(file.string(), (has_ending ? file.filename() : file.stem()).string());
}

/// Those of a story give way to what the command line says.
Json Choices::settings_with(const Story* story) const {
  Json settings = base_;
  if (story == nullptr) return settings;
  for (const auto& [path, value] : story->settings)
    if (std::find(fixed_.begin(), fixed_.end(), path) == fixed_.end()) settings[path] = value;
  return settings;
}

Choices::Chosen Choices::chosen(const Story* story, const Program& program,
                                const std::string& arithmetic) const {
  Chosen chosen;
  chosen.story = story;
  chosen.settings = settings_with(story);
  chosen.settings[elf_path_] = program.path;
  if (!arithmetic.empty()) chosen.settings[arithmetic_path_] = arithmetic;
  chosen.shown = {{"story", story == nullptr ? "" : story->name},
                  {"program", program.name},
                  {"arithmetic", arithmetic}};
  return chosen;
}

Choices::Chosen Choices::first(const Story* story) const {
  return chosen(story, programs_.front(), "");
}

Result<Choices::Chosen> Choices::choose(const Json& command) const {
  const auto wrong = [](const std::string& what) { return Error{"new: " + what}; };
  const std::string *const story = text_in(command, "story"),
                           *const program = text_in(command, "program"),
                           *const arithmetic = text_in(command, "arithmetic");
  if (story == nullptr || program == nullptr || arithmetic == nullptr)
    return wrong("story, program and arithmetic are texts");
  const Story* told = nullptr;
  if (!story->empty()) {
    const auto found = find_story(*story);
    if (!found) return wrong(found.error());
    told = found.value();
  }
  std::vector<std::string> names;
  for (const Program& each : programs_) names.push_back(each.name);
  const auto named = std::find(names.begin(), names.end(), program->empty() ? names[0] : *program);
  if (named == names.end())
    return wrong(fmt::format("there is no program '{}'; did you mean {}?", printable(*program, 80),
                             nearest_names(printable(*program, 80), names)));
  if (!arithmetic->empty() &&
      std::find(arithmetics_.begin(), arithmetics_.end(), *arithmetic) == arithmetics_.end())
    return wrong(fmt::format("arithmetic is {}", fmt::join(arithmetics_, " or ")));
  return chosen(told, programs_[static_cast<std::size_t>(named - names.begin())], *arithmetic);
}

Json Choices::shown() const {
  Json list = Json::array(), programs = Json::array();
  for (const Story& story : stories())
    list.push_back({{"name", story.name}, {"title", story.title}});
  for (const Program& program : programs_) programs.push_back(program.name);
  return {{"stories", std::move(list)},
          {"programs", std::move(programs)},
          {"arithmetics", arithmetics_}};
}

}  // namespace capsoc::view
