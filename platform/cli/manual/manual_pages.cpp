#include <fmt/format.h>

#include <cctype>

#include "manual/pages.h"

namespace capsoc::manual {
namespace {

/// Text of a paragraph: no character and no beginning of a line is a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool begins = out.empty() || out.back() == '\n';
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    switch (c) {
      case '\\':
        out += "\\e";
        break;
      case '-':
        out += "\\-";
        break;
      case '^':
        out += "\\(ha";
        break;
      case '~':
        out += "\\(ti";
        break;
      case '`':
        out += "\\(ga";
        break;
      case '\'':
        out += "\\(aq";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}

std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string page_name(const Command& command) {
  return joined(command.path, "-");
}

std::string path_of(const Command& command) {
  return "man/man1/" + page_name(command) + ".1";
}

/// "Range 1 to 100. Built-in: 3." after a help text.
std::string remarks(const Value& value, const std::string& built_in, bool repeats) {
  std::string text;
  if (!value.range.empty()) text += " Range: " + roff(value.range) + ".";
  if (!built_in.empty()) text += " Built\\-in: " + roff(built_in) + ".";
  if (repeats) text += " May be repeated.";
  return text;
}

std::string help_of(const std::string& help, const std::string& behind) {
  const bool ends = help.empty() || help.back() == '.' || behind.empty();
  return roff(help) + (ends ? "" : ".") + behind + "\n";
}

std::string usage_of(const Option& option) {
  std::string text;
  for (const std::string& name : option.names) text += (text.empty() ? "" : ", ") + bold(name);
  if (option.names.empty() || option.takes_value)
    text += (text.empty() ? "" : " ") + italic(option.value.name);
  return text;
}

std::string entry(const Option& option) {
  return ".TP\n" + usage_of(option) + "\n" +
         help_of(option.help, remarks(option.value, option.built_in, option.repeats));
}

std::string arguments(const Command& command) {
  std::string text;
  for (const Option& option : command.options)
    if (option.names.empty()) text += entry(option);
  return text.empty() ? "" : ".SH ARGUMENTS\n" + text;
}

/// In the declared order, a subsection where its own group begins.
std::string options(const Command& command) {
  std::string text, group;
  for (const Option& option : command.options) {
    if (option.names.empty()) continue;
    if (option.group != group) {
      if (!text.empty() || option.group != "Options") text += ".SS " + roff(option.group) + "\n";
      group = option.group;
    }
    text += entry(option);
  }
  return text.empty() ? "" : ".SH OPTIONS\n" + text;
}

std::string settings(const CommandLine& line, const Command& command) {
  const Option* taker = nullptr;
  for (const Option& option : command.options)
    if (option.value.setting) taker = &option;
  if (taker == nullptr) return "";
  std::string text = ".SH SETTINGS\n" + bold(taker->names.front()) +
                     " sets any of these. The environment sets them, too: "
                     "\\fBCAPSOC_\\fR and the path in capitals with _ for each dot.\n";
  for (const Setting& setting : line.settings) {
    const Value value = value_of(setting);
    // Where a file lies by default depends on where the program is.
    const std::string built_in = setting.is_path() ? "" : setting.value;
    text += ".TP\n" + bold(setting.path) + "=" + italic(value.name) + "\n" +
            help_of(setting.help, remarks(value, built_in, false));
  }
  return text;
}

std::string commands(const Command& command) {
  std::string text;
  for (const Command& inner : command.commands)
    text += ".TP\n" + bold(inner.path.back()) + "\n" +
            help_of(inner.help, fmt::format(" See \\fB{}\\fR(1).", roff(page_name(inner))));
  return text.empty() ? "" : ".SH COMMANDS\n" + text;
}

std::string synopsis(const Command& command) {
  std::string text = ".SH SYNOPSIS\n" + bold(joined(command.path, " "));
  for (const Option& option : command.options)
    if (option.names.empty())
      text += fmt::format(" [{}{}]", italic(option.value.name), option.repeats ? " ..." : "");
  text += " [" + italic("OPTION") + " ...]";
  if (!command.commands.empty()) text += " " + italic("COMMAND") + " ...";
  return text + "\n";
}

std::string exit_codes(const CommandLine& line) {
  std::string text = ".SH EXIT STATUS\n";
  for (const ExitCode& code : line.exit_codes)
    text += ".TP\n" + bold(code.code) + "\n" + roff(code.meaning) + "\n";
  return text;
}

/// Every other page.
std::string see_also(const CommandLine& line, const Command& command) {
  std::string text;
  for (const Command* other : all_commands(line.program))
    if (other != &command)
      text += fmt::format("{}\\fB{}\\fR(1)", text.empty() ? "" : ",\n", roff(page_name(*other)));
  return ".SH SEE ALSO\n" + text + "\n";
}

std::string page(const CommandLine& line, const Command& command) {
  const std::string own_name = command.path.back() + ": ";
  const bool named = command.help.rfind(own_name, 0) == 0;
  const std::string help = named ? command.help.substr(own_name.size()) : command.help;
  return ".\\\" Made by the program from the declarations of its command line.\n" +
         fmt::format(".TH {} 1 \"\" \"{} {}\" \"User Commands\"\n", upper(page_name(command)),
                     line.program.path.front(), line.version) +
         ".SH NAME\n" + roff(page_name(command)) + " \\- " + roff(help) + "\n" + synopsis(command) +
         ".SH DESCRIPTION\n" + help_of(help, "") + commands(command) + arguments(command) +
         options(command) + settings(line, command) + exit_codes(line) + see_also(line, command);
}

}  // namespace

std::vector<Page> manual_pages(const CommandLine& line) {
  std::vector<Page> pages;
  for (const Command* command : all_commands(line.program))
    pages.push_back({path_of(*command), page(line, *command)});
  return pages;
}

}  // namespace capsoc::manual
