#include "cli/setting_option.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace capsoc::cli {

void add_setting_option(CLI::App& command, const Setting& setting, TakeOption take) {
  using Form = SettingOption::Form;
  const SettingOption& declared = setting.command;
  const bool positional = declared.name.rfind('-', 0) != 0;
  const std::string given = positional ? declared.argument : declared.name;
  const auto set = [take = std::move(take), path = setting.path, given](const std::string& value) {
    take(path, value, given);
  };
  if (declared.form == Form::flag) {
    command.add_flag_callback(
        declared.name, [set, implied = declared.implied] { set(implied); }, declared.help);
    return;
  }
  if (declared.form == Form::list) {
    const auto join = [set](const std::vector<std::string>& places) {
      set(fmt::format("{}", fmt::join(places, ",")));
    };
    command.add_option_function<std::vector<std::string>>(declared.name, join, declared.help)
        ->type_name(declared.argument)
        ->allow_extra_args(false);
    return;
  }
  const auto set_or_imply = [set, implied = declared.implied](const std::string& value) {
    set(value.empty() && !implied.empty() ? implied : value);
  };
  CLI::Option* option =
      command.add_option_function<std::string>(declared.name, set_or_imply, declared.help);
  option->type_name(declared.argument);
  if (declared.form == Form::optional_value) option->expected(0, 1);
}

}  // namespace capsoc::cli
