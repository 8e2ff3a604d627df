#include "accuracy/report.h"

#include <algorithm>
#include <ostream>

namespace capsoc::accuracy {
namespace {

const char* verdict_name(Row::Verdict verdict) {
  static constexpr const char* names[] = {"", "holds", "misses", "clips"};
  return names[static_cast<int>(verdict)];
}

const char* verdict_text(Row::Verdict verdict) {
  static constexpr const char* texts[] = {"", "  precise holds", "  precise MISSES ITS BOUND",
                                          "  precise MISSES ITS BOUND: the signal clips"};
  return texts[static_cast<int>(verdict)];
}

/// Beyond this an angle of `paper`, which states no bound, is called wrong.
constexpr double wrong_angle_deg = 1;

}  // namespace

Figure degrees(double value) {
  return {fmt::format("{:.2e}", value), value};
}

bool Report::wants(const std::string& id) const {
  return chosen_.empty() || std::count(chosen_.begin(), chosen_.end(), id) != 0;
}

void Report::heading(const std::string& id, const std::string& title, const std::string& label,
                     const std::string& unit) {
  heading(id, title);
  line("  {:<54} {:>12} {:>12}", label, "precise" + unit, "paper" + unit);
}

void Report::heading(const std::string& id, const std::string& title) {
  tables_.push_back({id, title, {}});
  line("\n{}", title);
}

void Report::add(const Row& row) {
  const bool wrong = row.unit == "deg" && row.paper.value.value_or(0) > wrong_angle_deg;
  const char* const word = verdict_text(row.verdict);
  line("  {:<54} {:>12} {:>12}{}{}", row.label, row.precise.text, row.paper.text, word,
       !wrong       ? ""
       : *word != 0 ? ", paper is WRONG"
                    : "  paper is WRONG");
  add_data(row);
}

void Report::add_data(const Row& row) {
  if (row.verdict == Row::Verdict::misses || row.verdict == Row::Verdict::clips) ++missed_;
  const auto number = [](const std::optional<double>& value) {
    return value ? Field(*value) : Field();
  };
  // The columns of a label stand under those of the heading; a name has single spaces.
  std::string quantity;
  for (const char c : row.label)
    if (c != ' ' || (!quantity.empty() && quantity.back() != ' ')) quantity += c;
  tables_.back().rows.push_back({{"quantity", quantity},
                                 {"unit", row.unit},
                                 {"precise", number(row.precise.value)},
                                 {"paper", number(row.paper.value)},
                                 {"bound", number(row.bound)},
                                 {"verdict", std::string(verdict_name(row.verdict))}});
}

void Report::row(const std::string& label, const Comparison& c, std::optional<double> bound_deg) {
  Row row{label, "deg", degrees(c.precise.error_deg), degrees(c.paper.error_deg), bound_deg};
  if (bound_deg) row.verdict = verdict(c.precise.error_deg <= *bound_deg);
  if (c.precise.clipped) row.verdict = Row::Verdict::clips;
  add(row);
}

void Report::print(const std::string& text) {
  out_ << text << "\n";
}

}  // namespace capsoc::accuracy
