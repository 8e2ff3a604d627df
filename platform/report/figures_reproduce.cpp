// The figures of both papers that carry data, as `capsoc reproduce` draws them: ours, with the
// numbers that the papers print.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "report/figure.h"

namespace capsoc::report {
namespace {

constexpr const char* seconds = "time, s";
constexpr const char* angle_axis = "true angle, deg";
constexpr const char* error_axis = "angle error, deg";

struct PaperParameter {
  const char *name, *axis, *letter;
};
constexpr std::array<PaperParameter, 6> paper_parameters = {{{"a1", "a1, full scale", "(a)"},
                                                             {"a2", "a2, full scale", "(b)"},
                                                             {"b1", "b1, full scale", "(c)"},
                                                             {"b2", "b2, full scale", "(d)"},
                                                             {"beta", "beta, rad", "(f)"},
                                                             {"phi", "phi, rad", "(e)"}}};

/// The curves named after the figure, and the numbers that the rows of the tables have of the
/// papers.
Data data_of_paper(const Figure& figure, const Json& result) {
  Data data;
  const Json* curves = find(result, {"curves"});
  if (curves == nullptr || !curves->is_object()) return data;
  const std::string begin = figure.name + ".";
  for (const auto& [name, curve] : curves->items()) {
    if (name.compare(0, begin.size(), begin) != 0) continue;
    Curve found = curve_at(curve, {});
    if (!found.x.empty()) data.series.push_back({name.substr(begin.size()), std::move(found)});
  }
  if (figure.kind == Kind::bars && !data.series.empty())
    for (std::size_t i = 0; i < data.series.front().curve.x.size(); ++i)
      data.labels.push_back(i == 0 ? "mean" : std::to_string(i));
  if (data.series.empty()) return data;
  for (const Json* table : elements_at(result, {"tables"}))
    for (const Json* row : elements_at(*table, {"rows"}))
      for (const RowMark& mark : figure.marks) {
        if (text_at(*table, {"id"}) != mark.table || text_at(*row, {"quantity"}) != mark.quantity)
          continue;
        if (const auto value = number_at(*row, {"paper_value"}))
          data.marks.push_back(
              {fmt::format("paper{}: {}", mark.name, text_at(*row, {"paper"})), *value});
      }
  return data;
}

/// How far a row is from what it should be, as a share of how far it may be; nothing for a row
/// without a range.
std::optional<double> part_of_range(const Json& row) {
  const auto from = number_at(row, {"here_least"}), to = number_at(row, {"here_greatest"});
  const auto least = number_at(row, {"bound_least"}), greatest = number_at(row, {"bound_greatest"});
  const auto paper = number_at(row, {"paper_value"}), margin = number_at(row, {"tolerance"});
  if (!from || !to) return std::nullopt;
  const auto part = [](double distance, double allowed) {
    return allowed > 0 ? std::make_optional(distance / allowed) : std::nullopt;
  };
  if (margin && paper) return part(std::max({*from - *paper, *paper - *to, 0.0}), *margin);
  if (least && greatest) {
    const double middle = (*least + *greatest) / 2;
    return part(std::max(std::abs(*from - middle), std::abs(*to - middle)),
                (*greatest - *least) / 2);
  }
  if (greatest) return part(std::abs(*to), *greatest);
  return least && *from > 0 ? part(*least, *from) : std::nullopt;
}

Data all_rows(const Figure&, const Json& result) {
  Data data;
  Series series{"rows", {}};
  for (const Json* table : elements_at(result, {"tables"}))
    for (const Json* row : elements_at(*table, {"rows"})) {
      const auto part = part_of_range(*row);
      if (!part) continue;
      series.curve.add(static_cast<double>(data.labels.size()), 100 * *part);
      data.labels.push_back(
          fmt::format("{}: {}", text_at(*table, {"id"}), text_at(*row, {"quantity"})));
    }
  if (series.curve.x.empty()) return {};
  data.series.push_back(std::move(series));
  data.marks.push_back({"allowed", 100});
  return data;
}

Figure figure(const std::string& name, const std::string& section, const std::string& title,
              const std::string& caption, const std::string& papers, const std::string& x,
              const std::string& y, Kind kind = Kind::lines, bool log = false,
              std::vector<RowMark> marks = {}) {
  return {name, "reproduce", section, title, caption,       papers,
          x,    y,           kind,    log,   data_of_paper, std::move(marks)};
}

void add_soc_simulations(std::vector<Figure>& list) {
  list.push_back(figure("soc-6-a", "1", "Figure 6(a): Lissajous figure of Eq (21)",
                        "V over U of the simulated sensor, two turns.", "SoC paper, Figure 6(a)",
                        "U", "V", Kind::points));
  list.push_back(figure("soc-6-b", "1", "Figure 6(b): the signals",
                        "Both channels over two turns of 20 s.", "SoC paper, Figure 6(b)", seconds,
                        "signal, full scale"));
  list.push_back(figure(
      "soc-8", "1", "Figure 8: angle errors of the simulation",
      "Magnitude of the angle error without and with calibration by the parameters of 400 s.",
      "SoC paper, Figure 8", seconds, error_axis, Kind::lines, true,
      {{"1", "largest error uncalibrated", " at most"},
       {"1", "largest error calibrated", " at most"}}));
  for (const PaperParameter& p : paper_parameters)
    list.push_back(figure(fmt::format("soc-7-{}", p.name), "figure-7",
                          fmt::format("Figure 7{}: {}", p.letter, p.name),
                          "The LMSED in double precision with the paper's steps learns it.",
                          fmt::format("SoC paper, Figure 7{}", p.letter), seconds, p.axis,
                          Kind::lines, false, {{"1", p.name, ", Table 1"}}));
  list.push_back(figure("soc-7-error", "figure-7", "Figure 7(g): calculated error",
                        "Input minus estimate of both channels.", "SoC paper, Figure 7(g)", seconds,
                        "error, full scale"));
  list.push_back(figure("soc-7-signals", "figure-7", "Figure 7(h): calibrated signals",
                        "Sine and cosine by the parameters of 400 s, two turns.",
                        "SoC paper, Figure 7(h)", seconds, "signal"));
  for (const PaperParameter& p : paper_parameters)
    list.push_back(figure(fmt::format("soc-9-{}", p.name), "figure-9",
                          fmt::format("Figure 9{}: {}", p.letter, p.name),
                          "The same at 100 Hz with the larger steps.",
                          fmt::format("SoC paper, Figure 9{}", p.letter), seconds, p.axis,
                          Kind::lines, false, {{"1", p.name, ", preset"}}));
  for (const int m : {1, 2, 3, 4})
    list.push_back(figure(
        fmt::format("soc-10-{}", m), "figure-10",
        fmt::format("Figure 10({:c}): gain for m = -{}", 'a' + m - 1, m),
        "cos(mu(k) k) of Eq (23): what a speed disturbance leaves of an "
        "amplitude.",
        fmt::format("SoC paper, Figure 10({:c})", 'a' + m - 1), seconds, "gain", Kind::lines, false,
        m == 2 ? std::vector<RowMark>{{"figure-10", "m = -2, mean gain of the last 20 s",
                                       ", mean at the end"}}
               : std::vector<RowMark>{}));
}

void add_soc_rtl(std::vector<Figure>& list) {
  for (const PaperParameter& p : paper_parameters)
    list.push_back(figure(fmt::format("soc-12-{}", p.name), "figure-12",
                          fmt::format("Figure 12: {}", p.name),
                          "The coprocessor's model in the paper's arithmetic learns it.",
                          "SoC paper, Figure 12", seconds, p.axis, Kind::lines, false,
                          {{"8", fmt::format("{}, identified", p.name), ", Table 8"}}));
  list.push_back(figure("soc-13", "figure-13", "Figure 13: angle error of the RTL simulation",
                        "Magnitude of the error with the parameters of 400 s over the whole "
                        "record.",
                        "SoC paper, Figure 13", seconds, error_axis, Kind::lines, true,
                        {{"figure-13", "largest error calibrated", " at most"}}));
  list.push_back(figure("soc-14", "figure-13", "Figure 14: error of the arctangent",
                        "Magnitude of the PI loop's error for two magnitudes of its operands.",
                        "SoC paper, Figure 14", angle_axis, "error, rad", Kind::lines, true,
                        {{"figure-13", "arctangent, magnitude 1", ", magnitude 1"}}));
  list.push_back(figure("soc-16", "figure-17", "Figure 16: the signals of the experiment",
                        "Both channels of the rebuilt experiment, two turns.",
                        "SoC paper, Figure 16", seconds, "signal, full scale"));
  list.push_back(figure("soc-17", "figure-17", "Figure 17: angle error without calibration",
                        "Error of atan2(U, V) about its mean over a turn.", "SoC paper, Figure 17",
                        angle_axis, error_axis, Kind::lines, false,
                        {{"figure-17", "uncalibrated, largest", " at most"}}));
  list.push_back(figure(
      "soc-18", "figure-18", "Figure 18: angle errors of the experiment",
      "Errors about their mean over a turn: while learning, with the parameters stored at the "
      "end, and by the CSFN.",
      "SoC paper, Figure 18", angle_axis, error_axis, Kind::lines, false,
      {{"figure-18", "demodulation, largest", ", demodulation, at most"},
       {"figure-18", "calibration, largest", ", calibration, at most"},
       {"10", "after, largest", ", CSFN, at most"}}));
  for (const char letter : {'a', 'b'})
    list.push_back(figure(
        fmt::format("soc-19-{}", letter), "figure-19",
        fmt::format("Figure 19({}): amplitude spectrum of {}", letter, letter == 'a' ? "U" : "V"),
        "400 s at constant speed, without a window.",
        fmt::format("SoC paper, Figure 19({})", letter), "frequency, Hz", "amplitude, full scale",
        Kind::lines, true));
}

/// A group of figures of the CSFN paper that it has for the simulation and for the experiment.
void add_csfn_learning(std::vector<Figure>& list, const std::string& name,
                       const std::string& section, int first, const std::string& table) {
  struct Drawn {
    const char *what, *axis;
    int figure;
    char letter;
  };
  const Drawn drawn[] = {
      {"a1", "a1, full scale", first, 'a'},     {"a2", "a2, full scale", first, 'b'},
      {"b1", "b1, full scale", first + 1, 'a'}, {"b2", "b2, full scale", first + 1, 'b'},
      {"beta", "beta, rad", first + 2, 'a'},    {"loss", "mean of (1 - Y)^2", first + 2, 'b'}};
  for (const Drawn& d : drawn) {
    const bool loss = std::string(d.what) == "loss";
    std::vector<RowMark> marks;
    if (!loss && !table.empty()) marks = {{table, d.what, ", Table 2"}};
    list.push_back(figure(fmt::format("{}-{}", name, d.what), section,
                          fmt::format("CSFN paper, Figure {}({}): {}", d.figure, d.letter, d.what),
                          "The CSFN trained by Adam with the paper's batch, over its iterations.",
                          fmt::format("CSFN paper, Figure {}({})", d.figure, d.letter), "iteration",
                          d.axis, Kind::lines, loss, marks));
  }
}

void add_lissajous(std::vector<Figure>& list, const std::string& name, const std::string& section,
                   const std::string& papers, const std::string& what) {
  list.push_back(figure(name, section, papers + ": Lissajous figure, " + what,
                        "V over U of some samples of the record.", "CSFN paper, " + papers, "U",
                        "V", Kind::points));
}

void add_errors(std::vector<Figure>& list, const std::string& name, const std::string& section,
                int number) {
  for (const char letter : {'a', 'b'}) {
    const bool before = letter == 'a';
    list.push_back(figure(
        fmt::format("{}-{}", name, letter), section,
        fmt::format("Figure {}({}): angle error {} calibration", number, letter,
                    before ? "before" : "after"),
        fmt::format("About its mean, over the true angle; {} rows of the table are peak to peak.",
                    before ? "the \"before\"" : "the \"after\""),
        fmt::format("CSFN paper, Figure {}({})", number, letter), angle_axis, error_axis,
        Kind::lines, false, {}));
  }
}

void add_csfn(std::vector<Figure>& list) {
  list.push_back(figure("csfn-7-a", "csfn-1", "Figure 7(a), (b): the signals by sample",
                        "Angles in any order; zoom in for (b).", "CSFN paper, Figure 7(a) and (b)",
                        "sample", "signal, full scale"));
  list.push_back(figure("csfn-7-c", "csfn-1", "Figure 7(c): the signals by angle",
                        "The same samples over the true angle.", "CSFN paper, Figure 7(c)",
                        angle_axis, "signal, full scale"));
  add_lissajous(list, "csfn-7-d", "csfn-1", "Figure 7(d)", "simulation");
  add_lissajous(list, "csfn-11-a", "csfn-1", "Figure 11(a)", "calibrated");
  list.push_back(figure("csfn-11-b", "csfn-1", "Figure 11(b): calibrated sine and cosine",
                        "By the identified parameters, over the true angle.",
                        "CSFN paper, Figure 11(b)", angle_axis, "signal"));
  add_errors(list, "csfn-12", "csfn-1", 12);
  add_csfn_learning(list, "csfn-8", "csfn-figure-8", 8, "");
  list.push_back(figure("csfn-13-a", "csfn-figure-14", "Figure 13(a): signals with a harmonic",
                        "A third harmonic of 1 % of each amplitude.", "CSFN paper, Figure 13(a)",
                        angle_axis, "signal, full scale"));
  add_lissajous(list, "csfn-13-b", "csfn-figure-14", "Figure 13(b)", "with a third harmonic");
  add_errors(list, "csfn-14", "csfn-figure-14", 14);
  list.push_back(figure("csfn-16-a", "csfn-2", "Figure 16(a): the signals of the experiment",
                        "The rebuilt experiment over the true angle.", "CSFN paper, Figure 16(a)",
                        angle_axis, "signal, full scale"));
  add_lissajous(list, "csfn-16-b", "csfn-2", "Figure 16(b)", "experiment");
  list.push_back(figure("csfn-17", "csfn-2", "Figure 17: the shuffled signals",
                        "The same samples in the order in which they are learnt.",
                        "CSFN paper, Figure 17", "sample", "signal, full scale"));
  add_lissajous(list, "csfn-21-a", "csfn-2", "Figure 21(a)", "experiment calibrated");
  list.push_back(figure("csfn-21-b", "csfn-2", "Figure 21(b): calibrated sine and cosine",
                        "By the identified parameters, over the true angle.",
                        "CSFN paper, Figure 21(b)", angle_axis, "signal"));
  add_errors(list, "csfn-22", "csfn-2", 22);
  add_csfn_learning(list, "csfn-18", "csfn-figure-18", 18, "csfn-2");
  list.push_back(figure("csfn-23", "csfn-figure-23", "Figure 23: spectrum of the experiment",
                        "Amplitude of each order of the true angle, by least squares.",
                        "CSFN paper, Figure 23", "order", "amplitude, full scale", Kind::bars,
                        true));
}

}  // namespace

void add_reproduce_figures(std::vector<Figure>& list) {
  list.push_back({"reproduce-rows", "reproduce", "Result", "Every row within its range",
                  "How far our figure is from the paper's, or from the middle of its range, as a "
                  "share of how far it may be. Rows without a range are left out.",
                  "", "row", "of what is allowed, %", Kind::bars, false, all_rows});
  add_soc_simulations(list);
  add_soc_rtl(list);
  add_csfn(list);
}

}  // namespace capsoc::report
