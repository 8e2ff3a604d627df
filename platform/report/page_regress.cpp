// What the reports of `capsoc regress` and of the mutation score say next to their figures.
#include <fmt/format.h>

#include "report/html.h"
#include "report/page.h"

namespace capsoc::report {
namespace {

std::string runs_of(const Json& result) {
  std::string out;
  for (const char* arithmetic : arithmetics) {
    Table table{fmt::format("Runs, arithmetic {}", arithmetic),
                {"scenario", "seed", "samples", "accesses", "commits", "cycles", "difference"},
                {}};
    for (const Json* run : elements_at(result, {"arithmetics", arithmetic, "runs"})) {
      const std::string what = text_at(*run, {"difference", "what"});
      table.rows.push_back({text_at(*run, {"scenario"}),
                            shown_at(*run, {"seed"}),
                            shown_at(*run, {"samples"}),
                            shown_at(*run, {"accesses"}),
                            shown_at(*run, {"commits"}),
                            shown_at(*run, {"cycles"}),
                            {what.empty() ? "none" : what, what.empty() ? "good" : "bad"}});
    }
    out += html_of(table);
  }
  return out;
}

std::string difference_of(const Json& result) {
  for (const char* arithmetic : arithmetics)
    for (const Json* run : elements_at(result, {"arithmetics", arithmetic, "runs"})) {
      const Json* difference = find(*run, {"difference"});
      if (difference == nullptr) continue;
      return paragraph(
                 fmt::format("Arithmetic {}, scenario {}, seed {}, cycle {}: {}. First node: {}.",
                             arithmetic, text_at(*run, {"scenario"}), shown_at(*run, {"seed"}),
                             shown_at(*difference, {"cycle"}), text_at(*difference, {"what"}),
                             text_at(*difference, {"node"}))) +
             preformatted("Command that shows it again", text_at(*difference, {"command"})) +
             preformatted("Report", text_at(*difference, {"report"}));
    }
  return "";
}

/// Every bin, the missing ones marked in words, too: not by colour alone.
std::string coverage_of(const Json& result) {
  std::string out;
  for (const char* arithmetic : arithmetics) {
    const Json* groups = find(result, {"arithmetics", arithmetic, "coverage"});
    if (groups == nullptr || !groups->is_object()) continue;
    out += fmt::format("<h3>Arithmetic {}</h3>\n", arithmetic);
    for (const auto& [group, bins] : groups->items()) {
      if (!bins.is_object()) continue;
      out += "<p>" + escaped(group) + "</p>\n<ul class=\"map\">";
      for (const auto& [name, hits] : bins.items()) {
        const bool hit = number_at(hits, {}).value_or(0) > 0;
        out += fmt::format("<li{}>{}: {}</li>", hit ? "" : " class=\"bad\"", escaped(name),
                           hit ? escaped(shown_at(hits, {})) : "missing");
      }
      out += "</ul>\n";
    }
  }
  return out;
}

std::string rtl_coverage_of(const Json& result) {
  Table table{"Points of the RTL", {"arithmetic", "kind", "points", "covered", "excepted"}, {}};
  std::string missing;
  for (const char* arithmetic : arithmetics) {
    const Json* kinds = find(result, {"arithmetics", arithmetic, "rtl_coverage"});
    if (kinds == nullptr || !kinds->is_object()) continue;
    for (const auto& [kind, points] : kinds->items()) {
      table.rows.push_back({arithmetic, kind, shown_at(points, {"points"}),
                            shown_at(points, {"covered"}), shown_at(points, {"excepted"})});
      for (const Json* point : elements_at(points, {"missing"}))
        missing += text_at(*point, {}) + "\n";
    }
  }
  return html_of(table) + (missing.empty() ? "" : preformatted("Missing points", missing));
}

std::string files_of(const Json& result) {
  std::string out;
  for (const char* arithmetic : arithmetics) {
    Table table{fmt::format("Mutants by source file, arithmetic {}", arithmetic),
                {"file", "killed", "survived", "equivalent"},
                {}};
    const Json* files = find(result, {"arithmetics", arithmetic, "files"});
    if (files != nullptr && files->is_object())
      for (const auto& [file, counts] : files->items())
        table.rows.push_back({file, shown_at(counts, {"killed"}), shown_at(counts, {"survived"}),
                              shown_at(counts, {"equivalent"})});
    Table survivors{
        fmt::format("Survivors, arithmetic {}", arithmetic), {"number", "place", "what"}, {}};
    for (const Json* one : elements_at(result, {"arithmetics", arithmetic, "survivors"}))
      survivors.rows.push_back(
          {shown_at(*one, {"number"}), text_at(*one, {"place"}), {text_at(*one, {"what"}), "bad"}});
    out += html_of(table) + html_of(survivors);
  }
  return out;
}

}  // namespace

void add_regress_sections(Page& page) {
  const auto each = [&](std::string (*piece)(const Json&)) {
    return page.of_each("regress", piece);
  };
  const auto figures = [&](const char* section) { return page.figures_of("regress", section); };
  page.add("First difference", figures("First difference") + each(difference_of));
  page.add("Scenarios", figures("Scenarios") + each(runs_of));
  page.add("Functional coverage", each(coverage_of));
  page.add("Coverage of the RTL", figures("Coverage of the RTL") + each(rtl_coverage_of));
  page.add("Where it comes from", each(origin_of));
}

void add_mutation_sections(Page& page) {
  page.add("Mutation score",
           page.figures_of("mutation", "Mutation score") + page.of_each("mutation", files_of));
}

}  // namespace capsoc::report
