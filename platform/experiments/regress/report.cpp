#include "regress/report.h"

#include <fmt/format.h>

#include <map>

#include "support/xml.h"

namespace capsoc::regress {
namespace {

struct Row {
  uint64_t runs = 0, samples = 0, accesses = 0, commits = 0, edges = 0, differences = 0;

  void add(const Run& run) {
    ++runs;
    samples += run.counts.samples;
    accesses += run.counts.accesses;
    commits += run.counts.commits;
    edges += run.counts.edges;
    differences += run.finding ? 1 : 0;
  }
};

std::string line(const std::string& name, const Row& row) {
  return fmt::format("{:<16}{:>6}{:>12}{:>12}{:>12}{:>14}{:>12}\n", name, row.runs, row.samples,
                     row.accesses, row.commits, row.edges, row.differences);
}

std::string coverage_text(const Coverage& coverage) {
  size_t covered = 0;
  std::string missing;
  const auto bins = coverage.bins();
  for (const Coverage::Bin& bin : bins) {
    if (bin.hits > 0)
      ++covered;
    else
      missing += fmt::format("  missing: {}: {}\n", bin.group, bin.name);
  }
  return fmt::format("functional coverage: {} of {} bins\n{}", covered, bins.size(), missing);
}

std::string rtl_text(const RtlCoverage& rtl) {
  std::string text;
  for (const RtlCoverage::Kind& kind : rtl.kinds) {
    text += fmt::format("RTL {} coverage: {:.2f} % ({} of {}; {} excepted, {:.2f} % with these)\n",
                        kind.name, kind.percent(), kind.covered, kind.points - kind.excepted,
                        kind.excepted, kind.percent_of_all());
    for (const std::string& point : kind.missing) text += "  missing: " + point + "\n";
  }
  return text;
}

const Coverage* coverage_of(const Outcome& outcome, coprocessor::Arithmetic arithmetic) {
  for (const auto& [which, coverage] : outcome.coverage)
    if (which == arithmetic) return &coverage;
  return nullptr;
}

}  // namespace

std::string to_text(const Outcome& outcome, const std::vector<RtlCoverage>& rtl) {
  std::string text;
  for (const auto& [arithmetic, coverage] : outcome.coverage) {
    text += fmt::format("arithmetic {}\n{:<16}{:>6}{:>12}{:>12}{:>12}{:>14}{:>12}\n",
                        name_of(arithmetic), "scenario", "runs", "samples", "accesses", "commits",
                        "cycles", "differences");
    std::vector<std::pair<std::string, Row>> rows;
    Row total;
    for (const Run& run : outcome.runs) {
      if (run.arithmetic != arithmetic) continue;
      if (rows.empty() || rows.back().first != run.scenario->name)
        rows.emplace_back(run.scenario->name, Row{});
      rows.back().second.add(run);
      total.add(run);
    }
    for (const auto& [name, row] : rows) text += line(name, row);
    text += line("all", total);
    // A scenario ends at its first difference: what it has not reached by then says nothing.
    if (total.differences == 0) text += coverage_text(coverage);
    for (const RtlCoverage& each : rtl)
      if (each.arithmetic == name_of(arithmetic)) text += rtl_text(each);
    text += "\n";
  }
  if (const Run* run = outcome.first_difference()) {
    text +=
        fmt::format("DIFFERENCE in scenario {} ({}), seed {}, cycle {}: {}\n", run->scenario->name,
                    name_of(run->arithmetic), run->seed, run->finding->cycle, run->finding->what);
    if (!run->finding->node.empty())
      text += fmt::format("first wrong node: {}\n", run->finding->node);
    text += run->finding->report;
    if (!text.empty() && text.back() != '\n') text += '\n';
    text += fmt::format("again: {}\n", run->command);
  } else {
    text += "no difference\n";
  }
  return text;
}

nlohmann::ordered_json to_json(const Plan& plan, const Outcome& outcome,
                               const std::vector<RtlCoverage>& rtl) {
  nlohmann::ordered_json root;
  root["schema"] = "capsoc-regress-1";
  root["first_seed"] = plan.first_seed;
  root["seeds"] = plan.seeds;
  root["samples"] = plan.samples;
  root["accesses"] = plan.accesses;
  root["difference"] = outcome.first_difference() != nullptr;
  for (const auto& [arithmetic, coverage] : outcome.coverage) {
    nlohmann::ordered_json part;
    for (const Run& run : outcome.runs) {
      if (run.arithmetic != arithmetic) continue;
      nlohmann::ordered_json entry = {
          {"scenario", run.scenario->name}, {"seed", run.seed},
          {"samples", run.counts.samples},  {"accesses", run.counts.accesses},
          {"commits", run.counts.commits},  {"cycles", run.counts.edges}};
      if (run.finding)
        entry["difference"] = {{"cycle", run.finding->cycle},
                               {"what", run.finding->what},
                               {"node", run.finding->node},
                               {"command", run.command}};
      if (run.finding && !run.finding->waves.empty()) {
        entry["difference"]["report"] = run.finding->report;
        entry["difference"]["first_cycle"] = run.finding->first_cycle;
        for (const Wave& wave : run.finding->waves)
          entry["difference"]["waves"].push_back(
              {{"node", wave.node}, {"model", wave.model}, {"rtl", wave.rtl}});
      }
      part["runs"].push_back(std::move(entry));
    }
    auto missing = nlohmann::ordered_json::array();
    for (const Coverage::Bin& bin : coverage.bins()) {
      part["coverage"][bin.group][bin.name] = bin.hits;
      if (bin.hits == 0) missing.push_back(bin.group + ": " + bin.name);
    }
    part["missing"] = std::move(missing);
    for (const RtlCoverage& each : rtl) {
      if (each.arithmetic != name_of(arithmetic)) continue;
      for (const RtlCoverage::Kind& kind : each.kinds)
        part["rtl_coverage"][kind.name] = {{"points", kind.points},
                                           {"covered", kind.covered},
                                           {"excepted", kind.excepted},
                                           {"missing", kind.missing}};
    }
    root["arithmetics"][name_of(arithmetic)] = std::move(part);
  }
  return root;
}

std::string to_junit(const Outcome& outcome) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const auto& part : outcome.coverage) {
    const char* arithmetic = name_of(part.first);
    std::string cases;
    Row total;
    for (const Run& run : outcome.runs) {
      if (run.arithmetic != part.first) continue;
      total.add(run);
      cases += fmt::format("    <testcase classname=\"regress.{}\" name=\"{} seed {}\"", arithmetic,
                           run.scenario->name, run.seed);
      if (!run.finding) {
        cases += "/>\n";
        continue;
      }
      cases += fmt::format(">\n      <failure message=\"{}\">{}</failure>\n    </testcase>\n",
                           xml_text(run.finding->what),
                           xml_text("again: " + run.command + "\n" + run.finding->report));
    }
    text += fmt::format("  <testsuite name=\"regress {}\" tests=\"{}\" failures=\"{}\">\n",
                        arithmetic, total.runs, total.differences);
    const auto bins = coverage_of(outcome, part.first)->bins();
    size_t covered = 0;
    for (const Coverage::Bin& bin : bins) covered += bin.hits > 0 ? 1 : 0;
    text += fmt::format(
        "    <properties>\n      <property name=\"coverage bins\" value=\"{} of {}\"/>\n"
        "    </properties>\n",
        covered, bins.size());
    text += cases + "  </testsuite>\n";
  }
  return text + "</testsuites>\n";
}

}  // namespace capsoc::regress
