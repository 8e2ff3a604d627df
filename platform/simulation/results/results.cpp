#include "results/results.h"

#include <fmt/format.h>

#include <cmath>
#include <systemc>
#include <utility>

#include "base/json.h"
#include "base/printable.h"
#include "inputs/input_settings.h"
#include "version/version.h"

namespace capsoc::run {
namespace {

using nlohmann::ordered_json;

constexpr int schema_version = 1;

/// One parameter in every form that the result file and the table show.
struct Row {
  const char* name;
  int64_t word;
  double value;
  std::optional<double> truth;
  std::optional<double> relative_error;
};

std::vector<Row> rows_of(const metrics::ParameterWords& words,
                         const std::optional<metrics::Parameters>& truth, bool phi_comparable) {
  const metrics::Parameters value = metrics::to_values(words);
  const auto row = [&](const char* name, int64_t word, double found,
                       double metrics::Parameters::*member, bool angle) {
    Row r{name, word, found, std::nullopt, std::nullopt};
    const bool comparable = member != &metrics::Parameters::phi || phi_comparable;
    if (truth && comparable) {
      r.truth = (*truth).*member;
      const double difference =
          angle ? metrics::wrapped_difference(found, *r.truth) : found - *r.truth;
      if (*r.truth != 0) r.relative_error = difference / *r.truth;
    }
    return r;
  };
  return {row("a1", words.a1, value.a1, &metrics::Parameters::a1, false),
          row("a2", words.a2, value.a2, &metrics::Parameters::a2, false),
          row("b1", words.b1, value.b1, &metrics::Parameters::b1, false),
          row("b2", words.b2, value.b2, &metrics::Parameters::b2, false),
          row("beta", words.beta, value.beta, &metrics::Parameters::beta, true),
          row("phi", words.phi, value.phi, &metrics::Parameters::phi, true)};
}

/// In the state's own words: what the table prints and the result file says.
const char* name_of(metrics::Convergence::State state) {
  switch (state) {
    case metrics::Convergence::State::not_known:
      return "not known";
    case metrics::Convergence::State::not_reached:
      return "not reached";
    case metrics::Convergence::State::reached:
      return "reached";
  }
  return "";
}

/// `known`: the truth is; then the run did not come there.
std::string degrees(const std::optional<double>& value, bool known) {
  if (value) return fmt::format("{:.3g} deg", *value);
  return known ? "not reached" : "not known";
}

ordered_json parameters_json(const std::vector<Row>& rows) {
  ordered_json j;
  for (const Row& row : rows)
    j[row.name] = {{"word", row.word},
                   {"value", row.value},
                   {"true", number_or_null(row.truth)},
                   {"relative_error", number_or_null(row.relative_error)}};
  return j;
}

ordered_json sensors_json(const std::vector<SensorResult>& sensors) {
  ordered_json list = ordered_json::array();
  for (const SensorResult& sensor : sensors) {
    ordered_json j = {{"channel", list.size()},
                      {"path", sensor.file},
                      {"samples", sensor.samples},
                      {"valid", sensor.valid}};
    j["parameters"] = nullptr;
    if (sensor.samples > 0)
      j["parameters"] = parameters_json(rows_of(sensor.words, sensor.truth, false));
    j["angle_error_deg"] = {
        {"uncalibrated_max", number_or_null(sensor.errors.uncalibrated_max)},
        {"last_revolution", number_or_null(sensor.errors.calibrated_max_last_revolution)}};
    list.push_back(std::move(j));
  }
  return list;
}

/// A line for each of several sensors.
std::string sensors_table(const std::vector<SensorResult>& sensors) {
  std::string text;
  for (std::size_t channel = 0; channel < sensors.size(); ++channel) {
    const SensorResult& sensor = sensors[channel];
    const bool known = sensor.errors.angle_known;
    text += fmt::format(
        "channel {} ({}): {} samples, {} valid; largest angle error before {}, in the last turn "
        "{}\n",
        channel, printable(sensor.file, 200), sensor.samples, sensor.valid,
        degrees(sensor.errors.uncalibrated_max, known),
        degrees(sensor.errors.calibrated_max_last_revolution, known));
  }
  return text;
}

void add_sensor_results(const RunResult& result, ordered_json& j) {
  const metrics::Convergence& convergence = result.convergence;
  j["convergence"] = name_of(convergence.state);
  j["convergence_s"] = nullptr;
  if (convergence.state == metrics::Convergence::State::reached)
    j["convergence_s"] = convergence.since_s;
  j["parameters"] = parameters_json(rows_of(result.words, result.truth, result.phi_comparable));
  j["angle_error_deg"] = {
      {"uncalibrated_max", number_or_null(result.errors.uncalibrated_max)},
      {"uncalibrated_max_paper", number_or_null(result.errors.uncalibrated_max_paper)},
      {"calibrated_max_last_revolution",
       number_or_null(result.errors.calibrated_max_last_revolution)},
      {"calibration_mode_max", number_or_null(result.errors.calibration_mode_max)}};
}

ordered_json verdict_json(const metrics::ProgramVerdict& verdict) {
  ordered_json j;
  j["pass"] = verdict.pass;
  j["bound_deg"] = nullptr;
  j["reason"] = nullptr;
  if (verdict.pass) {
    j["bound_deg"] = verdict.bound_deg;
  } else {
    j["reason"] = verdict.reason;
  }
  j["samples"] = nullptr;
  if (verdict.samples) j["samples"] = *verdict.samples;
  j["motion_deg"] = number_or_null(verdict.motion_deg);
  j["conditions"] = verdict.conditions;
  j["largest_error_deg"] = number_or_null(verdict.largest_error_deg);
  j["bound_holds"] = nullptr;
  if (const auto holds = verdict.bound_holds()) j["bound_holds"] = *holds;
  return j;
}

std::string bound_line(const metrics::ProgramVerdict& verdict) {
  const auto holds = verdict.bound_holds();
  return fmt::format("the program's own bound       {:.3g} deg{}", verdict.bound_deg,
                     !holds   ? ": not known whether it holds"
                     : *holds ? ": holds"
                              : ": DOES NOT HOLD");
}

std::string sensor_table(const RunResult& result) {
  std::string text;
  const auto line = [&](const std::string& l) { text += l + "\n"; };
  line(fmt::format("{:<10}{:>14}{:>16}{:>16}{:>16}", "parameter", "word", "identified", "true",
                   "relative error"));
  for (const Row& row : rows_of(result.words, result.truth, result.phi_comparable))
    line(fmt::format("{:<10}{:>14}{:>16.9f}{:>16}{:>16}", row.name, row.word, row.value,
                     row.truth ? fmt::format("{:.9f}", *row.truth) : "not known",
                     row.relative_error ? fmt::format("{:.2e}", *row.relative_error) : "-"));
  line("");
  const metrics::AngleErrors& errors = result.errors;
  const metrics::Convergence& convergence = result.convergence;
  if (errors.angle_known) {
    line(fmt::format("largest angle error before    {} (as the paper counts: {})",
                     degrees(errors.uncalibrated_max, true),
                     degrees(errors.uncalibrated_max_paper, result.truth.has_value())));
    line(fmt::format("  last turn of demodulation   {}",
                     degrees(errors.calibrated_max_last_revolution, true)));
    line(fmt::format("  in calibration mode         {}",
                     degrees(errors.calibration_mode_max, true)));
  } else {
    line("angle errors                  not known: the true angle is not");
  }
  line(fmt::format("all six within 1 % after      {}",
                   convergence.state == metrics::Convergence::State::reached
                       ? fmt::format("{:.1f} s", convergence.since_s)
                       : name_of(convergence.state)));
  if (result.verdict && result.verdict->pass) line(bound_line(*result.verdict));
  return text;
}

/// A short time is not none.
std::string seconds(double value) {
  return value >= 1 ? fmt::format("{:.2f}", value) : fmt::format("{:.2g}", value);
}

}  // namespace

nlohmann::ordered_json versions() {
  ordered_json v;
  v["capsoc"] = version();
  v["commit"] = commit();
  v["systemc"] = sc_core::sc_version();
  v["compiler"] = "g++ " __VERSION__;
  v["fmt"] =
      fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100);
  v["nlohmann_json"] = fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR,
                                   NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH);
  return v;
}

std::string to_text(const ordered_json& json) {
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

namespace {

bool is_set(const Setting& setting) {
  return !setting.optional || setting.source != SettingSource::built_in;
}

ordered_json translator_json(const armv7m::TranslationCounts& counts) {
  const auto share = [&](uint64_t instructions) {
    return counts.executed == 0
               ? 0.0
               : static_cast<double>(instructions) / static_cast<double>(counts.executed);
  };
  return {{"blocks", counts.blocks},
          {"bytes", counts.bytes},
          {"evictions", counts.evictions},
          {"instructions", counts.instructions},
          {"share",
           {{"translator", share(counts.instructions)},
            {"blocks", share(counts.executed - counts.instructions - counts.stepped)},
            {"stepping", share(counts.stepped)}}}};
}

ordered_json task_json(const TaskTime& task, uint64_t cycles) {
  return {
      {"name", task.name},
      {"address", task.address},
      {"cycles", task.cycles},
      {"share", cycles == 0 ? 0.0 : static_cast<double>(task.cycles) / static_cast<double>(cycles)},
      {"switches", task.switches}};
}

ordered_json interrupt_json(const InterruptWait& wait) {
  ordered_json j;
  j["exception"] = wait.exception;
  j["name"] = wait.name;
  j["count"] = wait.count;
  j["latency_cycles"] = {{"least", wait.least},
                         {"mean", static_cast<double>(wait.sum) / static_cast<double>(wait.count)},
                         {"most", wait.most}};
  for (const InterruptWait::Bin& bin : wait.histogram)
    j["histogram"].push_back({{"from", bin.from}, {"to", bin.to}, {"count", bin.count}});
  return j;
}

std::string fault_line(const FaultOutcome& fault) {
  std::string text = fmt::format("fault: {}: ", fault.fault);
  if (!fault.applied) return text + "not applied: " + fault.note;
  text += fmt::format("at {:.12g} s, {:#x} became {:#x}", fault.time_s, fault.before, fault.after);
  if (fault.changes > 1) text += fmt::format(", {} times changed", fault.changes);
  return fault.note.empty() ? text : text + ": " + fault.note;
}

}  // namespace

nlohmann::ordered_json to_json(const trace::FunctionCost& function) {
  return {{"function", function.name},
          {"cycles", function.cost.cycles},
          {"instructions", function.cost.instructions}};
}

nlohmann::ordered_json to_json(const FaultOutcome& fault) {
  ordered_json j = {{"fault", fault.fault}, {"applied", fault.applied}};
  if (fault.applied) {
    j["time_s"] = fault.time_s;
    j["cycle"] = fault.cycle;
    j["instruction"] = fault.instruction;
    j["before"] = fault.before;
    j["after"] = fault.after;
    j["changes"] = fault.changes;
  }
  if (!fault.note.empty()) j["note"] = fault.note;
  return j;
}

nlohmann::ordered_json to_json(const RunResult& result, const Settings& settings) {
  ordered_json j;
  j["schema"] = schema_version;
  j["versions"] = versions();
  j["command"] = result.command;
  for (const Setting& setting : settings.all())
    if (setting.bearing != Bearing::place && is_set(setting))
      j["configuration"][setting.path] = setting.value;
  for (const ProgramValue& setting : result.program_settings)
    j["configuration"][program_prefix + setting.name] = setting.value;
  j["inputs"] = ordered_json::array();
  for (const Input& input : result.inputs)
    j["inputs"].push_back({{"role", input.role}, {"path", input.path}, {"sha256", input.sha256}});
  j["exit"] = {{"code", result.code}, {"reason", result.reason}};
  j["time"] = {{"simulated_s", result.simulated_s}, {"wall_s", result.wall_s}};
  j["cpu"]["instructions"] = result.instructions;
  j["cpu"]["cycles"] = result.cycles;
  j["cpu"]["mips"] =
      result.wall_s > 0 ? static_cast<double>(result.instructions) / result.wall_s / 1e6 : 0.0;
  if (result.translation) j["translator"] = translator_json(*result.translation);
  j["samples"] = result.samples;
  if (result.samples > 0) {
    add_sensor_results(result, j);
  } else {
    for (const char* key : {"convergence", "convergence_s", "parameters", "angle_error_deg"})
      j[key] = nullptr;
  }
  if (!result.sensors.empty()) j["sensors"] = sensors_json(result.sensors);
  j["verdict"] = nullptr;
  if (result.verdict) j["verdict"] = verdict_json(*result.verdict);
  if (!result.sensor_warnings.empty()) j["sensor_warnings"] = result.sensor_warnings;
  j["uart0"] = {{"bytes", result.uart0_bytes}, {"sha256", result.uart0_sha256}};
  if (result.report) {
    j["uart0"]["text"] = result.report->uart0_text;
    j["uart0"]["left_out"] = result.report->uart0_left_out;
    j["curves"] = capsoc::to_json(result.report->curves);
  }
  for (const trace::FunctionCost& function : result.profile)
    j["profile"].push_back(to_json(function));
  if (result.golden) j["golden"] = golden::to_json(*result.golden);
  if (!result.lost.empty()) j["lost"] = result.lost;
  if (!result.divergence.empty()) j["divergence"] = result.divergence;
  for (const StackUse& stack : result.stacks)
    j["stacks"].push_back({{"name", stack.name},
                           {"bytes", stack.top - stack.lowest},
                           {"top", stack.top},
                           {"lowest", stack.lowest}});
  for (const TaskTime& task : result.tasks) j["tasks"].push_back(task_json(task, result.cycles));
  for (const InterruptWait& wait : result.interrupt_waits)
    j["interrupts"].push_back(interrupt_json(wait));
  for (const FaultOutcome& fault : result.faults) j["faults"].push_back(to_json(fault));
  if (!result.fault_report.empty()) j["fault_report"] = result.fault_report;
  if (!result.place_report.empty()) j["place_report"] = result.place_report;
  return j;
}

std::string speed_of(double simulated_s, double wall_s) {
  const double speed = wall_s > 0 ? simulated_s / wall_s : 0;
  return speed >= 10 ? fmt::format("{:.0f}", speed) : fmt::format("{:.2g}", speed);
}

std::string to_table(const RunResult& result) {
  std::string text;
  const auto line = [&](const std::string& l) { text += l + "\n"; };
  line("");
  if (result.samples > 0) text += sensor_table(result);
  text += sensors_table(result.sensors);
  if (result.golden) text += golden::to_table(*result.golden) + "\n";
  for (const FaultOutcome& fault : result.faults) line(fault_line(fault));
  line(fmt::format("{}{} simulated s in {} s ({} times real time), {} instructions, {} cycles",
                   result.samples > 0 ? fmt::format("{} samples, ", result.samples) : "",
                   seconds(result.simulated_s), seconds(result.wall_s),
                   speed_of(result.simulated_s, result.wall_s), result.instructions,
                   result.cycles));
  const bool refused = result.code == exit_code::failed && result.verdict && !result.verdict->pass;
  line(
      fmt::format("exit {}: {}{}", result.code, result.reason,
                  refused && !result.verdict->reason.empty() ? ": " + result.verdict->reason : ""));
  return text;
}

}  // namespace capsoc::run
