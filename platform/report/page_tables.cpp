// What the reports of `capsoc reproduce`, `accuracy` and `bench` say: their tables, with the
// figures next to each.
#include <fmt/format.h>

#include <algorithm>

#include "report/html.h"
#include "report/page.h"

namespace capsoc::report {
namespace {

/// "unexpected" is what a reader has to find first.
const char* style_of(const std::string& verdict) {
  for (const char* good : {"agrees", "holds", "good"})
    if (verdict == good) return "good";
  for (const char* odd : {"known", "no QEMU", ""})
    if (verdict == odd) return "odd";
  return "bad";
}

/// A number as text with as many digits as a reader needs.
std::string number(const Json& row, const char* field) {
  const auto value = number_at(row, {field});
  return value ? fmt::format("{:.7g}", *value) : "-";
}

/// What ours may be, in words.
std::string bound_of(const Json& row) {
  const auto least = number_at(row, {"bound_least"}), greatest = number_at(row, {"bound_greatest"});
  if (least && greatest) return fmt::format("{:.7g} .. {:.7g}", *least, *greatest);
  if (greatest) return fmt::format("at most {:.7g}", *greatest);
  return least ? fmt::format("at least {:.7g}", *least) : "-";
}

/// "agrees within 0.005": no agreement without its tolerance.
std::string verdict_of_table(const Json& row) {
  std::string verdict = text_at(row, {"verdict"});
  if (verdict != "agrees") return verdict;
  const auto tolerance = number_at(row, {"tolerance"});
  return tolerance ? fmt::format("agrees within {:.7g}", *tolerance) : "agrees: " + bound_of(row);
}

std::string papers_rows(const Json& table) {
  Table out{text_at(table, {"title"}),
            {"quantity", "unit", "paper", "here", "ours may be", "verdict", "note"},
            {}};
  for (const Json* row : elements_at(table, {"rows"}))
    out.rows.push_back({text_at(*row, {"quantity"}),
                        text_at(*row, {"unit"}),
                        text_at(*row, {"paper"}),
                        text_at(*row, {"here"}),
                        bound_of(*row),
                        {verdict_of_table(*row), style_of(text_at(*row, {"verdict"}))},
                        text_at(*row, {"note"})});
  return html_of(out);
}

std::string other_rows(const Json& table) {
  Table out{text_at(table, {"title"}), {}, {}};
  const auto rows = elements_at(table, {"rows"});
  if (rows.empty() || !rows.front()->is_object()) return "";
  std::vector<std::string> fields;
  for (const auto& [name, value] : rows.front()->items()) fields.push_back(name);
  // Next to the name, where it is in view on a narrow screen, too.
  if (const auto at = std::find(fields.begin(), fields.end(), "verdict"); at != fields.end())
    std::rotate(std::min(fields.begin() + 1, at), at, at + 1);
  out.head = fields;
  for (const Json* row : rows) {
    std::vector<Cell> cells;
    for (const std::string& field : fields) {
      const Json* value = find(*row, {field.c_str()});
      const bool number_field = value != nullptr && value->is_number();
      const std::string text =
          number_field ? number(*row, field.c_str()) : shown_at(*row, {field.c_str()});
      cells.emplace_back(text, field == "verdict" ? style_of(text_at(*row, {"verdict"})) : "");
    }
    out.rows.push_back(std::move(cells));
  }
  return html_of(out);
}

struct TableSection {
  std::string id, title;
};

/// Of all results, in the order of the first that has each.
std::vector<TableSection> tables_of(const Page& page, const std::string& command) {
  std::vector<TableSection> all;
  for (const ResultFile& result : page.results()) {
    if (command_of(result.json) != command) continue;
    for (const Json* table : elements_at(result.json, {"tables"})) {
      const std::string id = text_at(*table, {"id"});
      const bool known = std::any_of(all.begin(), all.end(),
                                     [&](const TableSection& other) { return other.id == id; });
      if (!known) all.push_back({id, text_at(*table, {"title"})});
    }
  }
  return all;
}

void add_tables(Page& page, const std::string& command, std::string (*rows)(const Json& table)) {
  for (const TableSection& section : tables_of(page, command)) {
    std::string body = page.figures_of(command, section.id), tables;
    for (const ResultFile& result : page.results())
      if (command_of(result.json) == command)
        for (const Json* table : elements_at(result.json, {"tables"}))
          if (text_at(*table, {"id"}) == section.id)
            tables +=
                (page.results().size() > 1 ? "<h3>" + escaped(result.label) + "</h3>\n" : "") +
                rows(*table);
    page.add(section.title, body + tables);
  }
  page.add("Where it comes from", page.of_each(command, origin_of));
}

std::string verdicts_of(const Json& result) {
  Table out{"Rows by verdict", {"verdict", "rows"}, {}};
  for (const char* verdict : {"agrees", "holds", "known", "unexpected", ""}) {
    std::size_t count = 0;
    for (const Json* table : elements_at(result, {"tables"}))
      for (const Json* row : elements_at(*table, {"rows"}))
        if (text_at(*row, {"verdict"}) == verdict) ++count;
    // Only what is there is good or bad.
    out.rows.push_back(
        {{*verdict == '\0' ? "no comparison" : verdict, count > 0 ? style_of(verdict) : ""},
         std::to_string(count)});
  }
  return html_of(out) +
         (find(result, {"curves"}) == nullptr
              ? paragraph("This result has no curves: capsoc reproduce with --curves or --html.")
              : "");
}

}  // namespace

void add_reproduce_sections(Page& page) {
  page.add("Result",
           page.figures_of("reproduce", "Result") + page.of_each("reproduce", verdicts_of));
  add_tables(page, "reproduce", papers_rows);
}

void add_accuracy_sections(Page& page) {
  add_tables(page, "accuracy", other_rows);
}

void add_bench_sections(Page& page) {
  add_tables(page, "bench", other_rows);
}

}  // namespace capsoc::report
