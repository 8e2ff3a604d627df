#include "cli/command_tree.h"

namespace capsoc::cli {
namespace {

/// What the validators say of themselves. CLI11 tells how many there are by throwing.
std::vector<std::string> descriptions_of(CLI::Option& option) {
  std::vector<std::string> all;
  try {
    for (int i = 0;; ++i)
      if (std::string text = option.get_validator(i)->get_description(); !text.empty())
        all.push_back(std::move(text));
  } catch (const CLI::OptionNotFound&) {
    return all;
  }
}

manual::Value value_of(CLI::Option& option) {
  // The type's name is what stands before the validators' descriptions.
  std::string type_name = option.get_type_name();
  const std::vector<std::string> descriptions = descriptions_of(option);
  for (const std::string& description : descriptions)
    type_name.resize(type_name.size() - description.size() - 1);
  return manual::read_value(type_name, descriptions.empty() ? "" : descriptions.front());
}

manual::Option read_option(CLI::Option& option) {
  manual::Option read;
  for (const std::string& name : option.get_snames()) read.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) read.names.push_back("--" + name);
  read.group = option.get_group();
  read.help = option.get_description();
  read.built_in = option.get_default_str();
  read.takes_value = option.get_items_expected_max() > 0;
  read.may_lack_value = read.takes_value && option.get_items_expected_min() == 0;
  read.repeats = option.get_items_expected_max() > 1;
  read.value = value_of(option);
  return read;
}

manual::Command read_command(CLI::App& app, std::vector<std::string> path) {
  path.push_back(app.get_name());
  manual::Command command;
  command.path = path;
  command.help = app.get_description();
  for (CLI::Option* option : app.get_options())
    if (!option->get_group().empty()) command.options.push_back(read_option(*option));
  for (CLI::App* inner : app.get_subcommands([](CLI::App*) { return true; }))
    if (!inner->get_group().empty()) command.commands.push_back(read_command(*inner, path));
  return command;
}

}  // namespace

manual::Command command_tree(CLI::App& app) {
  return read_command(app, {});
}

}  // namespace capsoc::cli
