#include "regress/run_result.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace capsoc::regress {

using nlohmann::json;

std::string to_text(const Run& run, const Coverage& coverage) {
  const Bench::Counts& counts = run.counts;
  json result = {{"counts", {counts.samples, counts.accesses, counts.commits, counts.edges}},
                 {"coverage", coverage.counts()},
                 {"waves", run.has_waves}};
  if (const auto& finding = run.finding) {
    json& entry = result["finding"];
    entry = {{"kind", finding->kind}, {"cycle", finding->cycle},   {"what", finding->what},
             {"node", finding->node}, {"report", finding->report}, {"first", finding->first_cycle}};
    entry["waves"] = json::array();
    for (const Wave& wave : finding->waves)
      entry["waves"].push_back({wave.node, wave.model, wave.rtl});
  }
  return result.dump(-1, ' ', false, json::error_handler_t::replace);
}

bool take_text(const std::string& text, Run& run, Coverage& coverage) try {
  const json result = json::parse(text);
  const auto counts = result.at("counts").get<std::array<uint64_t, 4>>();
  std::optional<Finding> finding;
  if (result.contains("finding")) {
    const json& entry = result.at("finding");
    finding.emplace();
    entry.at("kind").get_to(finding->kind);
    entry.at("cycle").get_to(finding->cycle);
    entry.at("what").get_to(finding->what);
    entry.at("node").get_to(finding->node);
    entry.at("report").get_to(finding->report);
    entry.at("first").get_to(finding->first_cycle);
    for (const json& wave : entry.at("waves"))
      finding->waves.push_back({wave.at(0).get<std::string>(),
                                wave.at(1).get<std::vector<double>>(),
                                wave.at(2).get<std::vector<double>>()});
  }
  const bool waves = result.at("waves").get<bool>();
  if (!coverage.add(result.at("coverage").get<std::vector<uint64_t>>())) return false;
  run.counts = {counts[0], counts[1], counts[2], counts[3]};
  run.finding = std::move(finding);
  run.has_waves = waves;
  return true;
} catch (const json::exception&) {
  return false;
}

}  // namespace capsoc::regress
