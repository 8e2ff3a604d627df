// What a page of two results of one command says first.
#include <fmt/format.h>

#include <algorithm>

#include "report/comparison.h"
#include "report/html.h"
#include "report/page.h"

namespace capsoc::report {
namespace {

/// More rows than a reader looks through, and than a browser shows at once.
constexpr std::size_t most_rows = 500;

std::string key_of(const char* name, const std::string& label, const std::string& text,
                   const std::string& exact) {
  return fmt::format("<dd class=\"{}\" title=\"{}: {}\">{}</dd>", name, escaped(label),
                     escaped(exact), escaped(text.empty() ? "-" : text));
}

std::string keys_of(const Comparison& c) {
  if (c.figures.empty()) return "";
  std::string out = "<dl class=\"key\">\n";
  for (const ComparedFigure& figure : c.figures)
    out += fmt::format("<div><dt>{}</dt>{}{}</div>\n", escaped(figure.label),
                       key_of("a", c.label_a, figure.a, figure.exact_a),
                       key_of("b", c.label_b, figure.b, figure.exact_b));
  return out + "</dl>\n";
}

Cell cell_of(const std::string& text, const std::string& exact) {
  Cell cell(text);
  cell.exact = exact;
  return cell;
}

void add_row(Table& numbers, Table& texts, const Compared& value) {
  const Cell a = cell_of(value.a, value.exact_a), b = cell_of(value.b, value.exact_b);
  if (value.absolute.empty())
    texts.rows.push_back({value.name, a, b});
  else
    numbers.rows.push_back(
        {value.name, value.unit, a, b, value.absolute, Cell(value.relative, "n")});
}

std::string different_in(const ComparedPart& part) {
  const std::string title =
      fmt::format("{} that differ: {} of {}", part.title, part.different_count(), part.count());
  Table numbers{title, {"number", "unit", "A", "B", "B - A", "relative"}, {}, true};
  Table texts{title, {"name", "A", "B"}, {}, true};
  const std::size_t shown = std::min(most_rows, part.different.size());
  for (std::size_t i = 0; i < shown; ++i) add_row(numbers, texts, part.different[i]);
  if (!numbers.rows.empty()) texts.caption += "; texts, lists, and what one has alone";
  const std::size_t more = part.different.size() - shown;
  return html_of(numbers) + html_of(texts) +
         (more > 0 ? paragraph(fmt::format("And {} more.", more)) : "");
}

/// One line with the count; it opens to the values.
std::string same_in(const Comparison& c) {
  Table table{"Values that both have", {"name", "unit", "value"}, {}, true};
  std::size_t left_out = 0;
  for (const ComparedPart* part : {&c.settings, &c.answers, &c.values})
    for (const Compared& value : part->same) {
      if (table.rows.size() < most_rows)
        table.rows.push_back({value.name, value.unit, cell_of(value.a, value.exact_a)});
      else
        ++left_out;
    }
  std::string plots;
  for (const std::string& name : c.same_plots)
    plots += (plots.empty() ? "Plots: " : ", ") + figure_named(name)->title;
  std::string out = fmt::format("<details><summary>The same in both: {}</summary>\n{}",
                                escaped(count_of_same(c)), html_of(table));
  if (left_out > 0) out += paragraph(fmt::format("And {} more.", left_out));
  if (!plots.empty()) out += paragraph(plots + ".");
  return out + "</details>\n";
}

/// The plot that shows the answer, if it differs; else the first that does.
std::string lead_of(const Comparison& c) {
  for (const char* lead : {"angle-error", "fit-angle-error"})
    if (std::count(c.different_plots.begin(), c.different_plots.end(), lead) != 0) return lead;
  return c.different_plots.empty() ? "" : c.different_plots.front();
}

}  // namespace

std::string html_of(const Comparison& c) {
  std::string out = fmt::format("<p class=\"answer\"><span class=\"{}\">{}.</span></p>\n", c.style,
                                escaped(c.sentence));
  out += keys_of(c);
  const auto file = [](const char* name, const char* letter, const std::string& label,
                       const std::string& verdict) {
    return fmt::format("<span class=\"is-{}\">{}: {}{}</span>\n", name, letter, escaped(label),
                       verdict.empty() ? "" : ", " + escaped(verdict));
  };
  return out + "<p class=\"files\">" + file("a", "A", c.label_a, c.verdict_a) +
         file("b", "B", c.label_b, c.verdict_b) + "</p>\n";
}

void add_comparison_sections(Page& page, const Comparison& c) {
  const std::string lead = lead_of(c);
  std::string tables = different_in(c.answers) + different_in(c.settings);
  if (!tables.empty()) tables = "<div>\n" + tables + "</div>\n";
  if (const std::string plot = lead.empty() ? "" : page.figure(lead); !(plot + tables).empty())
    page.add("What differs", columns(plot + tables));
  page.leave_out(c.same_plots);
  page.add("Values", different_in(c.values) + same_in(c));
}

}  // namespace capsoc::report
