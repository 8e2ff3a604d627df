// What the report of `capsoc campaign` says next to its figures.
#include <fmt/format.h>

#include "report/fault_map.h"
#include "report/html.h"
#include "report/number_text.h"
#include "report/page.h"

namespace capsoc::report {
namespace {

std::string percent_at(const Json& json, Path path) {
  const auto value = number_at(json, path);
  return value ? percent(*value) : "-";
}

std::string four_digits(const Json& json, Path path) {
  const auto value = number_at(json, path);
  return value ? fmt::format("{:.4g}", *value) : "-";
}

std::string yield_of(const Json& result) {
  std::string out;
  const auto interval = elements_at(result, {"yield_interval"});
  if (interval.size() == 2)
    out += paragraph(fmt::format("95 % interval by Wilson: {} to {}; wanted are {}.",
                                 percent_at(*interval[0], {}), percent_at(*interval[1], {}),
                                 percent_at(result, {"least_yield"})));
  Table criteria{"Criteria, all of which a run has to meet", {"name", "runs", "expression"}, {}};
  for (const Json* each : elements_at(result, {"criteria"}))
    criteria.rows.push_back(
        {text_at(*each, {"name"}), shown_at(*each, {"met"}), text_at(*each, {"expression"})});
  Table exits{"How the runs ended", {"runs", "exit"}, {}};
  for (const Json* each : elements_at(result, {"exits"}))
    exits.rows.push_back({shown_at(*each, {"runs"}), text_at(*each, {"exit"})});
  return out + html_of(criteria) + html_of(exits);
}

/// A table for each thing that the campaign tells apart: how the runs of each value ended.
std::string groups_of(const Json& result) {
  std::string out;
  for (const Json* by : elements_at(result, {"by"})) {
    Table table{"By " + text_at(*by, {"name"}) + ": " + text_at(*by, {"expression"}),
                {"value", "runs", "passed", "how they ended"},
                {}};
    for (const Json* row : elements_at(*by, {"values"})) {
      std::string exits;
      for (const Json* exit : elements_at(*row, {"exits"}))
        exits += fmt::format("{}{} {}", exits.empty() ? "" : ", ", shown_at(*exit, {"runs"}),
                             text_at(*exit, {"exit"}));
      table.rows.push_back(
          {text_at(*row, {"value"}), shown_at(*row, {"runs"}), shown_at(*row, {"passed"}), exits});
    }
    out += html_of(table);
  }
  return out;
}

std::string quantiles_of(const Json& result) {
  constexpr const char* quantiles[] = {"0",    "0.01", "0.05", "0.25", "0.5",
                                       "0.75", "0.95", "0.99", "1"};
  Table table{"Quantiles of the finished runs",
              {"metric", "runs", "mean", "least", "1 %", "5 %", "25 %", "median", "75 %", "95 %",
               "99 %", "greatest", "expression"},
              {}};
  for (const Json* metric : elements_at(result, {"metrics"})) {
    std::vector<Cell> row = {text_at(*metric, {"name"}), shown_at(*metric, {"count"}),
                             four_digits(*metric, {"summary", "mean"})};
    for (const char* quantile : quantiles)
      row.emplace_back(four_digits(*metric, {"summary", "quantiles", quantile}));
    row.emplace_back(text_at(*metric, {"expression"}));
    table.rows.push_back(std::move(row));
  }
  return html_of(table);
}

std::string dependence_of(const Json& result) {
  Table table{
      "What depends on what", {"metric", "axis", "share", "by chance", "rank correlation"}, {}};
  for (const Json* metric : elements_at(result, {"metrics"})) {
    const Json* axes = find(*metric, {"sensitivity"});
    if (axes == nullptr || !axes->is_object()) continue;
    for (const auto& [axis, values] : axes->items())
      table.rows.push_back({text_at(*metric, {"name"}), axis, percent_at(values, {"share"}),
                            percent_at(values, {"chance"}), four_digits(values, {"correlation"})});
  }
  return html_of(table);
}

std::string examples_of(const Json& result, const char* which) {
  std::string out;
  for (const Json* each : elements_at(result, {which})) {
    const std::string name = fmt::format("run {}", shown_at(*each, {"run"}));
    out += paragraph(fmt::format("{}: {} = {}, {}", name, text_at(result, {"worst_metric"}),
                                 four_digits(*each, {"worst"}), text_at(*each, {"exit"})));
    out += preformatted("Command of " + name, text_at(*each, {"command"}));
  }
  return out;
}

std::string worst_of(const Json& result) {
  return examples_of(result, "worst");
}

std::string failures_of(const Json& result) {
  return examples_of(result, "failures");
}

std::string where_from(const Json& result) {
  Table table{"The campaign", {"what", "value"}, {}};
  for (const char* key : {"name", "kind", "version"})
    table.rows.push_back({key, text_at(result, {key})});
  return html_of(table);
}

/// The page's script makes it of the columns of the scatter plot.
constexpr const char* heat_map =
    "<div class=\"heat\" data-columns=\"campaign-any-two\" role=\"group\" "
    "aria-label=\"Heat map over two axes\"></div>\n";

}  // namespace

void add_campaign_sections(Page& page) {
  page.add("Yield", page.figures_of("campaign", "Yield") + page.of_each("campaign", yield_of));
  if (const std::string maps = page.of_each("campaign", fault_maps_of); !maps.empty())
    page.add("Map of the faults", maps);
  if (const std::string groups = page.of_each("campaign", groups_of); !groups.empty())
    page.add("By what", groups);
  page.add("Distributions",
           page.figures_of("campaign", "Distributions") + page.of_each("campaign", quantiles_of));
  page.add("What depends on what", page.figures_of("campaign", "What depends on what") +
                                       page.of_each("campaign", dependence_of));
  if (const std::string figures = page.figures_of("campaign", "Any two"); !figures.empty())
    page.add("Any two", figures + heat_map);
  page.add("The worst", page.of_each("campaign", worst_of));
  page.add("The first that did not pass", page.of_each("campaign", failures_of));
  page.add("Where it comes from", page.of_each("campaign", where_from));
}

}  // namespace capsoc::report
