// A comparison as text.
#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "report/comparison.h"
#include "report/number_text.h"

namespace capsoc::report {
namespace {

constexpr std::size_t most_lines = 40;
constexpr std::size_t widest_name = 48, widest_value = 24, longest_cell = 200;

std::string with_unit(const std::string& text, const Compared& value) {
  return value.unit.empty() || text == "-" ? text : text + " " + value.unit;
}

std::string table_line(const Compared& value, std::size_t name_width, std::size_t width) {
  const std::string name =
      fmt::format("  {:<{}}  ", printable(value.name, longest_cell), name_width);
  const std::string a = printable(with_unit(value.a, value), longest_cell);
  const std::string b = printable(with_unit(value.b, value), longest_cell);
  // Texts that are wider than a column stand below each other.
  if (std::max(a.size(), b.size()) > width)
    return name + "A: " + a + "\n" + std::string(name_width + 4, ' ') + "B: " + b + "\n";
  std::string line = fmt::format("{}{:<{}}  {:<{}}  {:>10}  {}", name, a, width, b, width,
                                 value.absolute, value.relative);
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

/// The widest of the texts that are shown, within bounds.
std::size_t width_of(const std::vector<std::string>& texts, std::size_t most) {
  constexpr std::size_t least = 8;
  std::size_t width = least;
  for (const std::string& text : texts)
    if (text.size() <= most) width = std::max(width, text.size());
  return width;
}

std::string part_text(const ComparedPart& part) {
  if (part.different.empty()) return "";
  std::string text =
      fmt::format("\n{} that differ: {} of {}\n", part.title, part.different_count(), part.count());
  const std::size_t shown = std::min(most_lines, part.different.size());
  std::vector<std::string> names, values;
  for (std::size_t i = 0; i < shown; ++i) {
    names.push_back(part.different[i].name);
    values.push_back(with_unit(part.different[i].a, part.different[i]));
    values.push_back(with_unit(part.different[i].b, part.different[i]));
  }
  const std::size_t name_width = width_of(names, widest_name);
  const std::size_t width = width_of(values, widest_value);
  text += fmt::format("  {:<{}}  {:<{}}  {:<{}}  {:>10}  {}\n", "", name_width, "A", width, "B",
                      width, "B - A", "relative");
  for (std::size_t i = 0; i < shown; ++i) text += table_line(part.different[i], name_width, width);
  if (shown < part.different.size())
    text += fmt::format("  and {} more; --html FILE has them\n", part.different.size() - shown);
  return text;
}

}  // namespace

std::string count_of_same(const Comparison& c) {
  const std::string values = counted(c.answers.same.size() + c.values.same.size(), "value");
  const std::string settings = counted(c.settings.same.size(), "setting");
  if (c.same_plots.empty()) return settings + " and " + values;
  return settings + ", " + values + " and " + counted(c.same_plots.size(), "plot");
}

std::string text_of(const Comparison& c) {
  std::string text = fmt::format("A  {}\nB  {}\n{}.\n", printable(c.label_a, longest_cell),
                                 printable(c.label_b, longest_cell), c.sentence);
  if (c.is_same()) return text;
  for (const ComparedPart* part : {&c.answers, &c.settings, &c.values}) text += part_text(*part);
  if (!c.different_plots.empty())
    text += fmt::format("\nplots that differ: {} of {}; --html FILE draws them\n",
                        c.different_plots.size(), c.different_plots.size() + c.same_plots.size());
  return text + fmt::format("\nThe same in both: {}.\n", count_of_same(c));
}

}  // namespace capsoc::report
