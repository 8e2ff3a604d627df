#include "reproduce/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ostream>

namespace capsoc::reproduce {

double Spread::least() const {
  return *std::min_element(values_.begin(), values_.end());
}
double Spread::greatest() const {
  return *std::max_element(values_.begin(), values_.end());
}

std::string number_text(double value) {
  return std::abs(value) >= 1e4 ? fmt::format("{:.0f}", value) : fmt::format("{:.4g}", value);
}

Bound Bound::around(double value, double part) {
  const double width = part * std::abs(value);
  return {value - width, value + width};
}

bool Bound::holds(const Figure& here) const {
  return here.least && here.greatest && (!least || *here.least >= *least) &&
         (!greatest || *here.greatest <= *greatest);
}

bool Bound::touches(const Figure& here) const {
  return here.least && here.greatest && (!least || *here.greatest >= *least) &&
         (!greatest || *here.least <= *greatest);
}

std::string Bound::text() const {
  if (least && greatest) return number_text(*least) + " .. " + number_text(*greatest);
  if (greatest) return "at most " + number_text(*greatest);
  return least ? "at least " + number_text(*least) : "anything";
}

Agreement lies_in(const Figure& here, const Bound& bound) {
  return {bound.holds(here), bound, std::nullopt, "(" + bound.text() + ")"};
}

Agreement Spread::admits(double printed, int decimals, double widened) const {
  const double margin = widened * (greatest() - least()) + 0.5 * std::pow(10.0, -decimals);
  const Bound bound{printed - margin, printed + margin};
  return {bound.touches(figure(decimals)), bound, margin,
          fmt::format("within {} of the range", number_text(margin))};
}

std::string Spread::text(int decimals) const {
  const std::string low = fmt::format("{:.{}f}", least(), decimals);
  const std::string high = fmt::format("{:.{}f}", greatest(), decimals);
  return low == high ? low : low + " .. " + high;
}

bool Report::wants(const std::vector<std::string>& ids) const {
  return chosen_.empty() || std::any_of(ids.begin(), ids.end(), [&](const std::string& id) {
           return std::count(chosen_.begin(), chosen_.end(), id) != 0;
         });
}

void Report::heading(const std::string& id) {
  shown_ = wants({id});
  if (!shown_) return;
  std::string title = id;
  for (const auto& [name, text] : table_names())
    if (name == id) title = text;
  tables_.push_back({id, title, {}});
  out_ << "\n" << title << "\n";
  line("", "paper", "here", "");
}

void Report::sentence(const std::string& text) {
  if (shown_) out_ << "  " << text << "\n";
}

void Report::row(const std::string& label, const Figure& paper, const Figure& here,
                 const Agreement& agreement) {
  add({label, paper, here, agreement.bound, agreement.tolerance,
       agreement.holds ? Row::Verdict::agrees : Row::Verdict::unexpected, agreement.text, ""});
}

void Report::known(const std::string& label, const Figure& paper, const Figure& here,
                   const Bound& bound, const std::string& why) {
  add({label, paper, here, bound, std::nullopt,
       bound.holds(here) ? Row::Verdict::known : Row::Verdict::unexpected, bound.text(), why});
}

void Report::ours(const std::string& label, const Figure& here, const Bound& bound) {
  add({label, "", here, bound, std::nullopt,
       bound.holds(here) ? Row::Verdict::holds : Row::Verdict::unexpected, "(" + bound.text() + ")",
       ""});
}

void Report::point(const std::string& label, const Figure& here) {
  add({label, "", here, {}, std::nullopt, Row::Verdict::none, "", ""});
}

void Report::stated(const std::string& label, const Figure& paper, const Figure& here) {
  add({label, paper, here, {}, std::nullopt, Row::Verdict::none, "", ""});
}

void Report::failure(const std::string& what, const std::string& reason) {
  shown_ = true;
  add({what, "", reason, {}, std::nullopt, Row::Verdict::unexpected, "when it is made", ""});
}

void Report::add(const Row& row) {
  if (!shown_) return;
  if (row.verdict == Row::Verdict::unexpected) ++unexpected_;
  line(row.label, row.paper.text, row.here.text, verdict_text(row));
  if (tables_.empty()) tables_.push_back({"", "", {}});
  tables_.back().rows.push_back(fields(row));
}

void Report::line(const std::string& label, const std::string& paper, const std::string& here,
                  const std::string& verdict) {
  std::string text = fmt::format("  {:<34} {:>10}  {:>18}  {}", label, paper, here, verdict);
  text.erase(text.find_last_not_of(' ') + 1);
  out_ << text << "\n";
}

std::string verdict_text(const Row& row) {
  switch (row.verdict) {
    case Row::Verdict::agrees:
      return "agrees " + row.limits;
    case Row::Verdict::known:
      return "differs (" + row.limits + "): " + row.why;
    case Row::Verdict::holds:
      return "holds " + row.limits;
    case Row::Verdict::none:
      return "";
    case Row::Verdict::unexpected:
      break;
  }
  return row.why.empty() ? "DIFFERS, and should not: agrees " + row.limits
                         : "OUT OF ITS BOUND (" + row.limits + "): " + row.why;
}

Fields fields(const Row& row) {
  const auto number = [](const std::optional<double>& value) {
    return value ? Field(*value) : Field();
  };
  std::string quantity = row.label, unit;
  for (const char* known : {"deg", "arc seconds", "rad", "%"}) {
    const std::string end = std::string(", ") + known;
    if (quantity.size() <= end.size() ||
        quantity.compare(quantity.size() - end.size(), end.size(), end) != 0)
      continue;
    quantity.erase(quantity.size() - end.size());
    unit = known;
    break;
  }
  const std::string& printed = row.paper.text;
  if (printed.size() > 2 && printed.compare(printed.size() - 2, 2, " s") == 0) unit = "s";
  const char* verdicts[] = {"agrees", "known", "unexpected", "holds", ""};
  return {{"quantity", quantity},
          {"unit", unit},
          {"paper", row.paper.text},
          {"paper_value", number(row.paper.least)},
          {"here", row.here.text},
          {"here_least", number(row.here.least)},
          {"here_greatest", number(row.here.greatest)},
          {"tolerance", number(row.tolerance)},
          {"bound_least", number(row.bound.least)},
          {"bound_greatest", number(row.bound.greatest)},
          {"verdict", std::string(verdicts[static_cast<int>(row.verdict)])},
          {"note", row.why}};
}

Figure::Figure(std::string printed) : text(std::move(printed)) {
  const char* begin = text.c_str();
  char* end = nullptr;
  const double value = std::strtod(begin, &end);
  if (end == begin || !std::isfinite(value)) return;
  least = greatest = value;
}

Figure fixed(double value, int decimals) {
  return {fmt::format("{:.{}f}", value, decimals), value};
}

Figure scientific(double value, int decimals) {
  return {fmt::format("{:.{}e}", value, decimals), value};
}

const std::vector<std::pair<std::string, std::string>>& table_names() {
  static const std::vector<std::pair<std::string, std::string>> names = {
      {"1", "Table 1, Figures 7 and 8: Eq (21), 250 Hz, 0.05 Hz, 400 s"},
      {"figure-7", "Figure 7: its learning curves"},
      {"2", "Table 2, Figure 9: convergence time with other frequencies and steps"},
      {"figure-9", "Figure 9: learning curves with its steps at 100 Hz"},
      {"3", "Table 3: noise with a peak of 10^n of each amplitude, parameters at 400 s"},
      {"4", "Table 4: the same, largest angle errors"},
      {"5", "Table 5: speed disturbance of Eq (22), peak 10^m of the frequency, 400 s"},
      {"6", "Table 6: the same, largest angle errors"},
      {"figure-10", "Figure 10: the gain cos(mu(k) k) of Eq (23) within 400 s"},
      {"7", "Table 7: resources, and the frequency of section 4.3"},
      {"8", "Table 8: the paper's arithmetic in the coprocessor model, machine values at 400 s"},
      {"figure-13", "Figures 13 and 14: the same, errors"},
      {"figure-12", "Figure 12: its learning curves"},
      {"figure-17", "Figure 17: the experiment, rebuilt, without calibration"},
      {"9", "Table 9: parameters of the experiment, machine values"},
      {"figure-18", "Figure 18: errors of the experiment"},
      {"10", "Table 10: the CSFN on the same samples"},
      {"comparison", "Section 4.3: three methods on the same samples, and one more"},
      {"11", "Table 11: times"},
      {"figure-19", "Figure 19: spectrum of the experiment"},
      {"csfn-1", "CSFN paper, Table 1 and Figure 12: relative errors of the simulation"},
      {"csfn-figure-8", "CSFN paper, Figures 8 to 10: its learning curves"},
      {"csfn-figure-14", "CSFN paper, Figure 14: a third harmonic of 1 %"},
      {"csfn-2", "CSFN paper, Table 2 and Figure 22: the experiment, rebuilt"},
      {"csfn-figure-18", "CSFN paper, Figures 18 to 20: its learning curves"},
      {"csfn-figure-23", "CSFN paper, Figure 23: spectrum of the experiment"},
  };
  return names;
}

Agreement within(double here, double printed, double tolerance) {
  return {std::abs(here - printed) <= tolerance,
          {printed - tolerance, printed + tolerance},
          tolerance,
          "within " + number_text(tolerance)};
}

Agreement agrees(double here, double printed, int decimals, double relative) {
  // The tiny addend lets a figure that lies exactly on half a unit round either way.
  const double unit = 0.5 * std::pow(10.0, -decimals) * (1.0 + 1e-9);
  return within(here, printed, std::max(unit, relative * std::abs(printed)));
}

}  // namespace capsoc::reproduce
