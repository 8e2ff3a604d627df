#include "fit/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "base/constants.h"
#include "base/json.h"

namespace capsoc::fit {
namespace {

using nlohmann::ordered_json;

constexpr int schema_version = 1;

/// One parameter in every form that the file and the table show.
struct ParameterRow {
  const char* name;
  int64_t word;
  double value;
  std::optional<double> interval;  ///< half width
  std::optional<double> truth;
  std::optional<double> relative_error;
};

std::vector<ParameterRow> rows_of(const Fit& fit) {
  using P = identification::Parameters;
  using I = identification::Intervals;
  const auto row = [&](const char* name, int64_t word, double P::*value, double I::*interval) {
    ParameterRow r{name, word, fit.answer.parameters.*value, {}, {}, {}};
    if (fit.answer.no_intervals.empty()) r.interval = fit.answer.intervals.*interval;
    if (!fit.truth) return r;
    r.truth = (*fit.truth).*value;
    if (*r.truth != 0) r.relative_error = (r.value - *r.truth) / *r.truth;
    return r;
  };
  return {row("a1", fit.words.a1, &P::a1, &I::a1), row("a2", fit.words.a2, &P::a2, &I::a2),
          row("b1", fit.words.b1, &P::b1, &I::b1), row("b2", fit.words.b2, &P::b2, &I::b2),
          row("beta", fit.words.beta, &P::beta, &I::beta),
          // Samples without their angles do not tell phi; the coprocessor takes 0.
          ParameterRow{"phi", fit.words.phi, 0, {}, {}, {}}};
}

ordered_json values_json(const identification::Parameters& p) {
  return {{"a1", p.a1}, {"a2", p.a2}, {"b1", p.b1}, {"b2", p.b2}, {"beta", p.beta}};
}

ordered_json gates_json(const identification::Identification& answer) {
  ordered_json gates = ordered_json::array();
  for (const identification::Gate& gate : answer.gates)
    gates.push_back({{"name", gate.name},
                     {"passed", gate.passed},
                     {"value", gate.value},
                     {"limit", gate.limit}});
  return gates;
}

ordered_json companions_json(const identification::Identification& answer) {
  ordered_json companions = ordered_json::array();
  for (const identification::Companion& companion : answer.companions) {
    ordered_json j;
    j["method"] = identification::to_string(companion.method);
    if (companion.parameters) {
      j["parameters"] = values_json(*companion.parameters);
      j["loss"] = companion.loss;
      j["difference"] = companion.difference;
    } else {
      j["error"] = companion.error;
    }
    companions.push_back(j);
  }
  return companions;
}

ordered_json attempts_json(const std::vector<Attempt>& attempts) {
  ordered_json j = ordered_json::array();
  for (const Attempt& attempt : attempts) {
    ordered_json a;
    a["method"] = attempt.method;
    if (attempt.parameters) {
      a["parameters"] = values_json(*attempt.parameters);
      a["loss"] = attempt.loss;
      a["iterations"] = attempt.iterations;
      a["difference"] = attempt.difference;
      a["angle_error_deg"] = number_or_null(attempt.angle_error_deg);
    } else {
      a["error"] = attempt.error;
    }
    j.push_back(a);
  }
  return j;
}

ordered_json term_json(const identification::HarmonicTerm& term) {
  return {{"sine", term.sine}, {"cosine", term.cosine}};
}

ordered_json harmonics_json(const identification::Harmonics& harmonics) {
  ordered_json j;
  j["identified"] = harmonics.identified;
  j["assumption"] = identification::to_string(harmonics.used);
  j["reason"] = harmonics.reason;
  j["check"] = {{"what", harmonics.check},
                {"value", harmonics.check_value},
                {"limit", harmonics.check_limit}};
  j["noise"] = harmonics.noise;
  if (!harmonics.identified) return j;
  for (const int order : {2, 3}) {
    const auto index = static_cast<std::size_t>(order - 2);
    j["order_" + std::to_string(order)] = {{"u", term_json(harmonics.model.u.at(index))},
                                           {"v", term_json(harmonics.model.v.at(index))}};
  }
  j["expected_error_deg"] = harmonics.expected_error * degrees_per_radian;
  j["coverage_error_deg"] = harmonics.coverage_error * degrees_per_radian;
  return j;
}

ordered_json error_table_json(const identification::ErrorCurve& curve) {
  ordered_json j;
  j["identified"] = curve.identified;
  j["reason"] = curve.reason;
  j["held_out_deg"] = {{"folds", identification::error_folds},
                       {"by", curve.by_turns ? "turns" : "sectors"},
                       {"rms_before", curve.before.rms * degrees_per_radian},
                       {"rms_after", curve.after.rms * degrees_per_radian},
                       {"largest_before", curve.before.largest * degrees_per_radian},
                       {"largest_after", curve.after.largest * degrees_per_radian}};
  j["reversed"] = curve.reversed;
  j["zero_deg"] = curve.zero * degrees_per_radian;
  if (!curve.identified) return j;
  j["order"] = curve.order;
  j["nodes"] = curve.nodes;
  return j;
}

std::string error_table_lines(const identification::ErrorCurve& curve) {
  std::string text =
      fmt::format("error table  {}{}\n", curve.identified ? "" : "none: ", curve.reason);
  if (curve.identified)
    text += fmt::format(
        "             held-out samples, about their mean: {:.3g} deg rms and {:.3g} at most "
        "before, "
        "{:.3g} rms and {:.3g} at most after\n",
        curve.before.rms * degrees_per_radian, curve.before.largest * degrees_per_radian,
        curve.after.rms * degrees_per_radian, curve.after.largest * degrees_per_radian);
  return text;
}

std::string error_table_macro(const identification::ErrorCurve& curve) {
  std::string text =
      "\n// The coprocessor's harmonic correction, 2^-24 turn\n#define CALIBRATION_NODES \\\n  {";
  for (std::size_t node = 0; node < curve.nodes.size(); ++node)
    text += fmt::format("{}{}",
                        node == 0        ? ""
                        : node % 16 == 0 ? ", \\\n   "
                                         : ", ",
                        curve.nodes[node]);
  return text + "}\n";
}

std::string degrees(const std::optional<double>& value) {
  return value ? fmt::format("{:.3g} deg", *value) : std::string("not known");
}

std::string how(const Fit& fit) {
  const identification::Identification& a = fit.answer;
  std::string text = identification::to_string(a.method);
  if (a.iterations > 0)
    text +=
        fmt::format(", {} after {} iterations", identification::to_string(a.stopped), a.iterations);
  if (a.method == identification::Method::adam) text += fmt::format(", seed {}", a.seed);
  return text;
}

std::string attempts_table(const std::vector<Attempt>& attempts) {
  std::string text =
      fmt::format("\n{:<10}{:>13}{:>13}{:>13}{:>13}{:>13}{:>11}{:>12}{:>7}\n", "method", "a1", "a2",
                  "b1", "b2", "beta", "difference", "angle error", "steps");
  for (const Attempt& attempt : attempts) {
    const std::string& name = attempt.method;
    if (!attempt.parameters) {
      text += fmt::format("{:<10}  {}\n", name, attempt.error);
      continue;
    }
    const identification::Parameters& p = *attempt.parameters;
    const std::string error =
        attempt.angle_error_deg ? fmt::format("{:.3g}", *attempt.angle_error_deg) : "-";
    text += fmt::format("{:<10}{:>13.9f}{:>13.9f}{:>13.9f}{:>13.9f}{:>13.9f}{:>11.1e}{:>12}{:>7}\n",
                        name, p.a1, p.a2, p.b1, p.b2, p.beta, attempt.difference, error,
                        attempt.iterations);
  }
  return text +
         "difference: from the answer, relative to the amplitude or in rad; "
         "angle error: peak to peak, deg\n";
}

std::string harmonics_table(const identification::Harmonics& harmonics) {
  std::string text = fmt::format("harmonics    {}: {}\n", identification::to_string(harmonics.used),
                                 harmonics.reason);
  if (!harmonics.identified) return text;
  text += fmt::format("{:<13}{:>14}{:>14}{:>14}{:>14}\n", "", "u sine", "u cosine", "v sine",
                      "v cosine");
  for (const std::size_t index : {0, 1}) {
    const identification::HarmonicTerm &u = harmonics.model.u.at(index),
                                       &v = harmonics.model.v.at(index);
    text += fmt::format("  order {:<5}{:>14.9f}{:>14.9f}{:>14.9f}{:>14.9f}\n", index + 2, u.sine,
                        u.cosine, v.sine, v.cosine);
  }
  return text;
}

/// The first of them, and how many there are.
std::string outliers_line(const identification::Identification& answer) {
  if (answer.outliers.empty()) return "";
  constexpr std::size_t named = 8;
  std::string text = fmt::format(
      "outliers     {} left out, {:.2g} to {:.2g} times the noise off: ", answer.outliers.size(),
      answer.nearest_outlier, answer.farthest_outlier);
  for (std::size_t i = 0; i < std::min(named, answer.outliers.size()); ++i)
    text += fmt::format("{}{}", i == 0 ? "samples " : ", ", answer.outliers[i]);
  return text + (answer.outliers.size() > named ? " ...\n" : "\n");
}

std::string deg(double radians) {
  return fmt::format("{:.2g}", radians * degrees_per_radian);
}

std::string error_text(const identification::AngleError& error, bool tested) {
  const std::string harmonics =
      tested ? fmt::format(
                   "with harmonics of several orders, as large as the residuals leave room "
                   "for: {} deg",
                   deg(error.total))
             : std::string("of harmonics these samples show nothing");
  return fmt::format(
      "{} deg at {:g} % confidence, if the channels have no harmonics (noise {}, method {}, drift "
      "{}, resolution {})\n             {}\n",
      deg(error.parameters), 100 * identification::bound_confidence, deg(error.noise),
      deg(error.method), deg(error.drift), deg(error.resolution), harmonics);
}

/// What the noise of one sample makes of its angle, root of the mean square over the turn, radians.
double noise_of_one_sample(const identification::Identification& answer) {
  const identification::Parameters& p = answer.parameters;
  return answer.residuals.noise * std::hypot(1 / p.a1, 1 / p.a2) /
         (std::sqrt(2.0) * std::abs(std::cos(p.beta)));
}

/// What is guaranteed, or why nothing is.
std::string bound_line(const identification::Identification& answer) {
  if (!answer.bound) return fmt::format("angle bound  none: {}\n", answer.warning);
  const identification::AngleBound& bound = *answer.bound;
  if (answer.harmonics.identified)
    return fmt::format(
        "angle bound  over the whole turn {} deg with the harmonics taken off: 4 times the "
        "expected "
        "error\n             for the angle at its sampling instant, if the assumption of {} "
        "holds\n",
        deg(bound.total), identification::to_string(answer.harmonics.used));
  const bool tested = answer.structure.last_order > 0;
  std::string text = fmt::format("angle bound  over the whole turn {}", error_text(bound, tested));
  if (bound.arc_degrees < 360)
    text += fmt::format("             over the {:.0f} degrees that the samples cover {}",
                        bound.arc_degrees, error_text(bound.arc, tested));
  return text +
         fmt::format(
             "             for the angle at its sampling instant; not in it: what disturbs one "
             "sample ({} deg rms here), and\n"
             "             a single harmonic that moves samples along the ellipse\n",
             deg(noise_of_one_sample(answer)));
}

ordered_json error_json(const identification::AngleError& error) {
  return {{"total", error.total * degrees_per_radian},
          {"parameters", error.parameters * degrees_per_radian},
          {"confidence", identification::bound_confidence},
          {"noise", error.noise * degrees_per_radian},
          {"harmonics", error.harmonics * degrees_per_radian},
          {"method", error.method * degrees_per_radian},
          {"drift", error.drift * degrees_per_radian},
          {"resolution", error.resolution * degrees_per_radian}};
}

ordered_json bound_json(const identification::Identification& answer) {
  if (!answer.bound) return nullptr;
  ordered_json j = error_json(*answer.bound);
  j["arc_degrees"] = answer.bound->arc_degrees;
  j["arc"] = error_json(answer.bound->arc);
  return j;
}

/// Why there are no intervals, and what the samples are.
std::string notes_lines(const identification::Identification& answer) {
  std::string text;
  if (!answer.no_intervals.empty()) text += "intervals    none: " + answer.no_intervals + "\n";
  for (const std::string& note : answer.notes) text += "note         " + note + "\n";
  return text;
}

std::string gates_line(const identification::Identification& answer) {
  std::string names;
  for (const identification::Gate& gate : answer.gates)
    names += (names.empty() ? "" : ", ") + gate.name;
  return "gates        passed: " + names + "\n";
}

bool has_scale(const sensor::Description& d) {
  return d.full_scale != 1 || d.zero != 0;
}

/// A recording's unit is worth a word.
bool has_unit(const sensor::Description& d) {
  return has_scale(d) || d.step.has_value();
}

std::string full_scale_text(const sensor::Description& d) {
  return fmt::format("{}{}full scale {}, zero {}", d.unit, d.unit.empty() ? "" : ": ", d.full_scale,
                     d.zero);
}

std::string header_unit_line(const sensor::Description& d) {
  if (!has_scale(d)) return "";
  return fmt::format("// Parameters are of (value - zero) / full scale; {}\n", full_scale_text(d));
}

std::string unit_line(const sensor::Description& d) {
  if (!has_unit(d)) return "";
  std::string text = "values       ";
  if (has_scale(d)) text += full_scale_text(d);
  if (d.step)
    text += fmt::format("{}in steps of {:.4g} of full scale{}", text.back() == ' ' ? "" : ", ",
                        *d.step, fmt::format(" ({:.4g} bits)", 1 - std::log2(*d.step)));
  return text + "\n";
}

std::string angle_error_line(const Fit& fit) {
  if (!fit.angle_column.empty())
    return fmt::format("angle error  not known: {}\n", fit.angle_column);
  if (!fit.errors.uncalibrated && !fit.errors.calibrated)
    return "angle error  not known: the record has no true angle\n";
  return fmt::format("angle error  {} before, {} after (peak to peak)\n",
                     degrees(fit.errors.uncalibrated), degrees(fit.errors.calibrated));
}

}  // namespace

ordered_json to_json(const Fit& fit, const ordered_json& versions, const std::string& command) {
  const identification::Identification& answer = fit.answer;
  ordered_json j;
  j["schema"] = schema_version;
  j["versions"] = versions;
  j["command"] = command;
  j["inputs"] = ordered_json::array(
      {{{"role", "sensor"}, {"path", fit.record.path}, {"sha256", fit.record.sha256}}});
  j["samples"] = fit.record.samples.u.size();
  j["adc_bits"] = fit.record.adc_bits;
  if (const sensor::Description& d = fit.record.description; has_unit(d))
    j["unit"] = {{"name", d.unit},
                 {"full_scale", d.full_scale},
                 {"zero", d.zero},
                 {"step", number_or_null(d.step)}};
  if (!fit.record.warnings.empty()) j["sensor_warnings"] = fit.record.warnings;
  j["method"] = identification::to_string(answer.method);
  j["stop_reason"] = identification::to_string(answer.stopped);
  j["iterations"] = answer.iterations;
  j["seed"] = answer.seed;
  j["loss"] = answer.loss;
  for (const ParameterRow& row : rows_of(fit))
    j["parameters"][row.name] = {{"word", row.word},
                                 {"value", row.value},
                                 {"true", number_or_null(row.truth)},
                                 {"relative_error", number_or_null(row.relative_error)},
                                 {"interval", number_or_null(row.interval)}};
  j["confidence"] = answer.intervals.confidence;
  j["handedness"] = identification::to_string(answer.handedness);
  j["residuals"] = {{"rms", answer.residuals.rms},
                    {"largest", answer.residuals.largest},
                    {"noise", answer.residuals.noise},
                    {"angle_deg", noise_of_one_sample(answer) * degrees_per_radian}};
  j["angle_bound_deg"] = bound_json(answer);
  j["warning"] = answer.warning;
  j["no_intervals"] = answer.no_intervals;
  j["notes"] = answer.notes;
  j["outliers"] = answer.outliers;
  j["structure"] = {{"found", answer.structure.found},
                    {"order", answer.structure.order},
                    {"amplitude", answer.structure.amplitude},
                    {"noise", answer.structure.noise},
                    {"probability", answer.structure.probability}};
  j["gates"] = gates_json(answer);
  j["companions"] = companions_json(answer);
  j["disagreement"] = answer.disagreement;
  j["harmonics"] = harmonics_json(answer.harmonics);
  j["angle_column"] = fit.angle_column;
  if (fit.error_curve) j["error_table"] = error_table_json(*fit.error_curve);
  j["angle_error_deg"] = {
      {"uncalibrated_peak_to_peak", number_or_null(fit.errors.uncalibrated)},
      {"calibrated_peak_to_peak", number_or_null(fit.errors.calibrated)},
      {"with_harmonics_peak_to_peak", number_or_null(fit.errors.with_harmonics)}};
  if (!fit.attempts.empty()) j["methods"] = attempts_json(fit.attempts);
  return j;
}

std::string to_header(const Fit& fit) {
  // There is no literal for INT32_MIN.
  const auto fraction = [](int32_t word) {
    return word == INT32_MIN ? std::string("(-2147483647 - 1)") : fmt::format("({})", word);
  };
  std::string text = fmt::format(
      "// Calibration words for the firmware (parameter_block.h), by capsoc fit.\n"
      "// Samples: {}, SHA-256 {}\n"
      "// Method: {}\n"
      "{}"
      "#ifndef CALIBRATION_H\n#define CALIBRATION_H\n\n"
      "// Q1.31\n",
      std::filesystem::path(fit.record.path).filename().string(), fit.record.sha256, how(fit),
      header_unit_line(fit.record.description));
  for (const ParameterRow& row : rows_of(fit)) {
    const std::string name = row.name;
    const bool angle = name == "beta" || name == "phi";
    if (name == "beta") text += "\n// 2^-32 turn\n";
    std::string upper = name;
    for (char& c : upper)
      if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    text +=
        fmt::format("#define CALIBRATION_{} {} // {:.12g}{}\n", upper,
                    angle ? fmt::format("{}u", row.word) : fraction(static_cast<int32_t>(row.word)),
                    row.value, angle ? " rad" : "");
  }
  if (fit.error_curve && fit.error_curve->identified) text += error_table_macro(*fit.error_curve);
  return text + "\n#endif\n";
}

std::string to_convergence(const Fit& fit) {
  std::string text = "iteration,loss,a1,a2,b1,b2,beta\n";
  for (const identification::TracePoint& point : fit.answer.convergence) {
    const identification::Parameters& p = point.parameters;
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", point.iteration, point.loss,
                   p.a1, p.a2, p.b1, p.b2, p.beta);
  }
  return text;
}

std::string to_table(const Fit& fit) {
  const identification::Identification& answer = fit.answer;
  // A recording's step is in the next line; 32 bits are no converter.
  const std::string bits =
      fit.record.adc_bits < 32 ? fmt::format(", {} bits", fit.record.adc_bits) : "";
  std::string text = fmt::format("trace        {}: {} samples{}\n", fit.record.path,
                                 fit.record.samples.u.size(), bits);
  text += unit_line(fit.record.description);
  text += fmt::format("method       {}\n\n", how(fit));
  text += fmt::format("{:<10}{:>14}{:>16}{:>14}{:>16}{:>16}\n", "parameter", "word", "identified",
                      fmt::format("+- ({:g} %)", 100 * answer.intervals.confidence), "true",
                      "relative error");
  for (const ParameterRow& row : rows_of(fit))
    text += fmt::format("{:<10}{:>14}{:>16.9f}{:>14}{:>16}{:>16}\n", row.name, row.word, row.value,
                        row.interval ? fmt::format("{:.1e}", *row.interval) : "-",
                        row.truth ? fmt::format("{:.9f}", *row.truth) : "not known",
                        row.relative_error ? fmt::format("{:.2e}", *row.relative_error) : "-");
  text += fmt::format("\nresidual     {:.2e} rms, {:.2e} at most; noise {:.2e} of full scale\n",
                      answer.residuals.rms, answer.residuals.largest, answer.residuals.noise);
  text += fmt::format("rotation     {}\n", identification::to_string(answer.handedness));
  text += gates_line(answer);
  text += outliers_line(answer);
  text += notes_lines(answer);
  text += bound_line(answer);
  if (!answer.disagreement.empty()) text += fmt::format("companions   {}\n", answer.disagreement);
  if (!answer.harmonics.reason.empty()) text += harmonics_table(answer.harmonics);
  text += angle_error_line(fit);
  if (fit.errors.with_harmonics)
    text += fmt::format("             {} with the harmonics taken off\n",
                        degrees(fit.errors.with_harmonics));
  if (fit.error_curve) text += error_table_lines(*fit.error_curve);
  if (!fit.attempts.empty()) text += attempts_table(fit.attempts);
  return text;
}

}  // namespace capsoc::fit
