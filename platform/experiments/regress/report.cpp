#include "regress/report.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "base/shell.h"
#include "base/xml.h"
#include "trace/save_file.h"

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

/// While runs are missing it says nothing which bins are, too.
std::string coverage_text(const Coverage& coverage, bool complete) {
  size_t covered = 0;
  std::string missing;
  const auto bins = coverage.bins();
  for (const Coverage::Bin& bin : bins) {
    if (bin.hits > 0)
      ++covered;
    else
      missing += fmt::format("  missing: {}: {}\n", bin.group, bin.name);
  }
  return fmt::format("functional coverage: {} of {} bins\n{}", covered, bins.size(),
                     complete ? missing : "");
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

/// That shows the waves, and makes them if they are not there yet.
std::string wave_command(const Run& run) {
  if (run.has_waves) {
    const std::string waves = run.waves_file + ".fst";
    return fmt::format("gtkwave {} {}", shell_word(waves), shell_word(trace::save_file(waves)));
  }
  const std::string name =
      fmt::format("{}-{}-{}", name_of(run.arithmetic), run.scenario->name, run.seed);
  return fmt::format("{} --waves waves; gtkwave waves/{}.fst waves/{}.gtkw", run.command, name,
                     name);
}

const Subject* subject_of(const Plan& plan, coprocessor::Arithmetic arithmetic) {
  for (const Subject& subject : plan.subjects)
    if (subject.arithmetic == arithmetic) return &subject;
  return nullptr;
}

std::string subject_text(const Plan& plan, coprocessor::Arithmetic arithmetic) {
  const Subject* subject = subject_of(plan, arithmetic);
  if (subject == nullptr) return {};
  return fmt::format(", RTL {:.12}, compared at its {}", subject->hash, subject->seen);
}

const char* text_of(Finding::Kind kind) {
  switch (kind) {
    case Finding::Kind::difference:
      return "difference";
    case Finding::Kind::wrong:
      return "wrong";
    case Finding::Kind::no_result:
      return "no result";
  }
  return "";
}

/// The JUnit plug-ins of Jenkins and GitLab keep what such a line names.
std::string attachment(const std::string& file) {
  std::error_code ignored;
  return fmt::format("[[ATTACHMENT|{}]]\n", std::filesystem::absolute(file, ignored).string());
}

std::string test_case(const Run& run) {
  std::string text = fmt::format("    <testcase classname=\"regress.{}\" name=\"{} seed {}\"",
                                 name_of(run.arithmetic), run.scenario->name, run.seed);
  if (!run.done) return text + "><skipped message=\"not done yet\"/></testcase>\n";
  text += fmt::format(" time=\"{:.3f}\"", run.wall_s);
  if (!run.finding) return text + "/>\n";
  const bool ended = run.finding->kind == Finding::Kind::no_result;
  std::string report = "again: " + run.command + "\n";
  if (run.finding->kind == Finding::Kind::difference)
    report += "waves: " + wave_command(run) + "\n";
  text += fmt::format(">\n      <{0} message=\"{1}\">{2}</{0}>\n", ended ? "error" : "failure",
                      xml_text(run.finding->what), xml_text(report + run.finding->report));
  if (run.has_waves)
    text += "      <system-out>" +
            xml_text(attachment(run.waves_file + ".fst") + attachment(run.waves_file + ".gtkw")) +
            "</system-out>\n";
  return text + "    </testcase>\n";
}

}  // namespace

std::string to_text(const Plan& plan, const Outcome& outcome, const std::vector<RtlCoverage>& rtl) {
  std::string text;
  for (const auto& [arithmetic, coverage] : outcome.coverage) {
    text += fmt::format("arithmetic {}{}\n{:<16}{:>6}{:>12}{:>12}{:>12}{:>14}{:>12}\n",
                        name_of(arithmetic), subject_text(plan, arithmetic), "scenario", "runs",
                        "samples", "accesses", "commits", "cycles", "differences");
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
    if (total.differences == 0) text += coverage_text(coverage, outcome.complete());
    for (const RtlCoverage& each : rtl)
      if (each.arithmetic == name_of(arithmetic)) text += rtl_text(each);
    text += "\n";
  }
  if (!outcome.complete())
    text += fmt::format("PARTIAL: {} of {} runs are done\n", outcome.done(), outcome.runs.size());
  if (const Run* run = outcome.first_failure()) {
    text += fmt::format("{} in scenario {} ({}), seed {}, cycle {}: {}\n",
                        run->finding->kind == Finding::Kind::no_result ? "NO RESULT" : "DIFFERENCE",
                        run->scenario->name, name_of(run->arithmetic), run->seed,
                        run->finding->cycle, run->finding->what);
    if (!run->finding->node.empty())
      text += fmt::format("first wrong node: {}\n", run->finding->node);
    text += run->finding->report;
    if (!text.empty() && text.back() != '\n') text += '\n';
    text += fmt::format("again: {}\n", run->command);
    if (run->finding->kind == Finding::Kind::difference)
      text += fmt::format("waves: {}\n", wave_command(*run));
  } else {
    text += outcome.complete() ? "no difference\n" : "no difference until here\n";
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
  root["difference"] = outcome.first_failure() != nullptr;
  if (!outcome.complete())
    root["partial"] = {{"done", outcome.done()}, {"of", outcome.runs.size()}};
  for (const auto& [arithmetic, coverage] : outcome.coverage) {
    nlohmann::ordered_json part;
    if (const Subject* subject = subject_of(plan, arithmetic))
      part["rtl"] = {{"sources", subject->hash}, {"compared", subject->seen}};
    part["runs"] = nlohmann::ordered_json::array();
    for (const Run& run : outcome.runs) {
      if (run.arithmetic != arithmetic || !run.done) continue;
      nlohmann::ordered_json entry = {
          {"scenario", run.scenario->name}, {"seed", run.seed},
          {"samples", run.counts.samples},  {"accesses", run.counts.accesses},
          {"commits", run.counts.commits},  {"cycles", run.counts.edges}};
      if (run.finding)
        entry["difference"] = {{"kind", text_of(run.finding->kind)},
                               {"cycle", run.finding->cycle},
                               {"what", run.finding->what},
                               {"node", run.finding->node},
                               {"command", run.command}};
      if (run.finding && run.finding->kind == Finding::Kind::no_result)
        entry["difference"]["report"] = run.finding->report;
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
    double seconds = 0;
    uint64_t errors = 0, skipped = 0;
    for (const Run& run : outcome.runs) {
      if (run.arithmetic != part.first) continue;
      total.add(run);
      cases += test_case(run);
      seconds += run.wall_s;
      errors += run.finding && run.finding->kind == Finding::Kind::no_result ? 1 : 0;
      skipped += run.done ? 0 : 1;
    }
    text += fmt::format(
        "  <testsuite name=\"regress {}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" "
        "skipped=\"{}\" "
        "time=\"{:.3f}\">\n",
        arithmetic, total.runs, total.differences - errors, errors, skipped, seconds);
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
