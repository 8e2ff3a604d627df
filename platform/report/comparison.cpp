#include "report/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "base/printable.h"
#include "report/figure.h"
#include "report/headline.h"
#include "report/number_text.h"
#include "report/values.h"

namespace capsoc::report {
namespace {

constexpr int least_digits = 3;
constexpr std::size_t longest_text = 60;

/// What is a setting and what is the answer, by command: patterns of keys.
struct Patterns {
  const char* command;
  std::vector<const char*> settings, answers;
  std::vector<const char*> bound;  ///< the one number of the answer
  const char* bound_name;
};

const std::vector<const char*>& settings_of_all() {
  static const std::vector<const char*> all = {"schema", "versions", "command", "configuration",
                                               "inputs"};
  return all;
}

const Patterns& patterns_of(const std::string& command) {
  static const std::vector<const char*> verdicts = {"tables.*.rows.*.verdict"};
  static const std::vector<Patterns> all = {
      {"run",
       {},
       {"exit", "verdict", "convergence", "golden.angle.verdict", "divergence"},
       {"verdict", "bound_deg"},
       "bound"},
      {"fit",
       {"method", "seed", "adc_bits", "unit", "confidence"},
       {"gates.*.passed", "angle_bound_deg.total", "handedness", "warning"},
       {"angle_bound_deg", "total"},
       "bound"},
      {"campaign",
       {"name", "kind", "version", "runs", "least_yield", "worst_metric", "criteria.*.expression",
        "metrics.*.expression"},
       {"done", "passed", "yield", "criteria.*.met"},
       {"yield"},
       "yield"},
      {"regress",
       {"first_seed", "seeds", "samples", "accesses", "arithmetics.*.rtl"},
       {"difference", "partial", "arithmetics.*.missing"},
       {},
       ""},
      {"", {}, verdicts, {}, ""}};
  const auto found = std::find_if(all.begin(), all.end() - 1,
                                  [&](const Patterns& each) { return command == each.command; });
  return *found;
}

bool matches_any(const Value& value, const std::vector<const char*>& patterns) {
  return std::any_of(patterns.begin(), patterns.end(),
                     [&](const char* pattern) { return matches(value.keys, pattern); });
}

/// What stands there, through several objects.
const Json* at_path(const Json& json, const std::vector<const char*>& path) {
  const Json* at = &json;
  for (const char* key : path)
    if (at != nullptr) at = find(*at, {key});
  return at;
}

bool is_list(const Json* json) {
  return json != nullptr && json->is_structured();
}

constexpr std::size_t short_list = 4;

/// A list as text: its elements if they are few.
std::string list_text(const Json& list) {
  if (list.size() > short_list) return fmt::format("{} entries", list.size());
  std::string text;
  for (const Json& element : list) {
    const std::string one = shown_at(element, {});
    text += (text.empty() ? "" : ", ") + (is_number(one) ? shortened(one) : one);
  }
  return "[" + text + "]";
}

std::string plain_text(const Json* json) {
  if (json == nullptr) return "-";
  if (json->is_string() && json->get_ref<const std::string&>().empty()) return "(empty)";
  return is_list(json) ? list_text(*json) : shown_at(*json, {});
}

/// The line of a text around a place, cut to what is near it.
std::string line_around(const std::string& text, std::size_t at) {
  constexpr std::size_t before = 20;
  const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;  // 0 after no line
  const std::string line = text.substr(begin, text.find('\n', at) - begin);
  std::size_t from = at - begin;
  if (line.size() <= longest_text || from <= before) return printable(line, longest_text);
  for (from -= before;
       from < line.size() && (static_cast<unsigned char>(line[from]) & 0xC0U) == 0x80U;)
    ++from;  // not inside of a character
  return "..." + printable(line.substr(from), longest_text);
}

/// Two texts cut to what tells them apart: the first line that differs.
void set_texts(Compared& both, const std::string& a, const std::string& b) {
  const auto at = static_cast<std::size_t>(
      std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin());
  const bool lines = a.find('\n') != std::string::npos || b.find('\n') != std::string::npos;
  const auto number = std::count(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
  const std::string begin = lines ? fmt::format("line {}: ", number) : "";
  const auto shown = [&](const std::string& text) {
    return text.empty() ? "(empty)" : begin + line_around(text, at);
  };
  both.a = shown(a);
  both.b = shown(b);
  // A long path has a place for all of it, a log has none.
  if (!lines) both.exact_a = a, both.exact_b = b;
}

/// b as a share of a.
std::string relative_text(double a, double b) {
  constexpr double many = 10;
  if (a == 0 || !std::isfinite(b / a)) return "";
  const double times = b / a;
  if (std::abs(times) >= many || (times != 0 && std::abs(times) <= 1 / many))
    return "x " + three_digits(times);
  return fmt::format("{:+.3g} %", 100 * (b - a) / std::abs(a));
}

void set_numbers(Compared& both, const Json& a, const Json& b) {
  constexpr double exact = 1e15;  // the difference of whole numbers up to here is whole, too
  const double x = a.get<double>(), y = b.get<double>();
  const bool whole =
      a.is_number_integer() && b.is_number_integer() && std::abs(x) < exact && std::abs(y) < exact;
  both.relative = relative_text(x, y);
  both.absolute = whole ? fmt::format("{:+.0f}", y - x) : fmt::format("{:+.3g}", y - x);
  if (whole) return;
  both.exact_a = both.a;
  both.exact_b = both.b;
  std::tie(both.a, both.b) = told_apart(x, y, least_digits);
}

/// Of a checksum the beginning tells as much.
void shorten_checksum(Compared& both, const std::string& key) {
  constexpr std::size_t enough = 12;
  if (key != "sha256" && key != "sources") return;
  for (std::string* text : {&both.a, &both.b})
    if (text->size() > enough) text->resize(enough);
}

/// Values that are the same, or have nothing in common.
void set_whole(Compared& both, const Json* a, const Json* b, bool are_other_lists) {
  const auto exact = [](const Json* json, const std::string& text) {
    if (!is_list(json) || json->size() > short_list) return text;
    return json->dump(-1, ' ', false, Json::error_handler_t::replace);
  };
  both.exact_a = exact(a, both.a);
  both.exact_b = exact(b, both.b);
  for (std::string* text : {&both.a, &both.b})
    *text = is_number(*text) ? shortened(*text) : printable(*text, longest_text);
  if (are_other_lists && both.a == both.b) both.b += ", others";
}

Compared compared_values(const Value& value, const Json* a, const Json* b) {
  Compared both{value.name(), value.unit, plain_text(a), plain_text(b), "", "", "", ""};
  const bool differ = a != nullptr && b != nullptr && !(*a == *b);
  if (differ && number_at(*a, {}) && number_at(*b, {}))
    set_numbers(both, *a, *b);
  else if (differ && a->is_string() && b->is_string())
    set_texts(both, text_at(*a, {}), text_at(*b, {}));
  else
    set_whole(both, a, b, differ && is_list(a) && is_list(b));
  shorten_checksum(both, value.keys.back());
  return both;
}

/// Names of all values, and of all that has values below it.
class Names {
 public:
  explicit Names(const std::vector<Value>& values) {
    for (const Value& value : values)
      for (std::size_t depth = 1; depth <= value.keys.size(); ++depth)
        all_.insert(value.name(depth));
  }
  /// How many keys name the largest part with the value that is not among them.
  std::size_t depth_of_missing(const Value& value) const {
    std::size_t depth = 1;
    while (depth < value.keys.size() && all_.count(value.name(depth)) != 0) ++depth;
    return depth;
  }

 private:
  std::unordered_set<std::string> all_;
};

class Comparer {
 public:
  Comparer(Comparison& comparison, const Patterns& patterns, const Json& a, const Json& b)
      : c_(comparison), patterns_(patterns), of_a_(values_of(a)), of_b_(values_of(b)) {}

  /// Every value of either result goes into its part.
  void compare() {
    std::unordered_map<std::string, const Json*> in_b;
    for (const Value& value : of_b_) in_b.emplace(value.name(), value.json);
    const Names names_a(of_a_), names_b(of_b_);
    for (const Value& value : of_a_) {
      const auto found = in_b.find(value.name());
      if (found == in_b.end()) {
        add_missing(value, names_b, true);
        continue;
      }
      const bool same = *value.json == *found->second;
      ComparedPart& part = part_of(value);
      (same ? part.same : part.different)
          .push_back(compared_values(value, value.json, found->second));
      in_b.erase(found);
    }
    for (const Value& value : of_b_)
      if (in_b.count(value.name()) != 0) add_missing(value, names_a, false);
  }

 private:
  ComparedPart& part_of(const Value& value) {
    if (matches_any(value, settings_of_all()) || matches_any(value, patterns_.settings))
      return c_.settings;
    return matches_any(value, patterns_.answers) ? c_.answers : c_.values;
  }

  /// A table that only one result has is one difference, with the count of its values.
  void add_missing(const Value& value, const Names& others, bool in_a) {
    if (value.json->is_null()) return;  // neither has it
    const std::size_t depth = others.depth_of_missing(value);
    if (depth == value.keys.size()) {
      part_of(value).different.push_back(
          compared_values(value, in_a ? value.json : nullptr, in_a ? nullptr : value.json));
      return;
    }
    const std::string name = value.name(depth);
    // What is missing as a whole is no answer and no setting, but the parts of a setting are.
    auto& list = (matches_any(value, settings_of_all()) ? c_.settings : c_.values).different;
    if (list.empty() || list.back().name != name) {
      list.push_back({name, "", "-", "-", "", "", "", ""});
      list.back().values = 0;
    }
    const std::string text = counted(++list.back().values, "value");
    (in_a ? list.back().a : list.back().b) = text;
  }

  Comparison& c_;
  const Patterns& patterns_;
  const std::vector<Value> of_a_, of_b_;
};

bool same_numbers(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

bool same_plot(const Data& a, const Data& b) {
  if (a.labels != b.labels || a.series.size() != b.series.size()) return false;
  for (std::size_t i = 0; i < a.series.size(); ++i) {
    const Series &x = a.series[i], &y = b.series[i];
    if (x.name != y.name || !same_numbers(x.curve.x, y.curve.x) ||
        !same_numbers(x.curve.y, y.curve.y) || !same_numbers(x.low, y.low))
      return false;
  }
  return true;
}

void compare_plots(Comparison& c, const Json& a, const Json& b) {
  const std::string command = command_of(a);
  for (const Figure& figure : figures()) {
    if (figure.command != command) continue;
    const Data left = figure.data(figure, a), right = figure.data(figure, b);
    if (left.series.empty() && right.series.empty()) continue;
    if (!left.columns.all.empty() || !right.columns.all.empty()) continue;  // of one result each
    (same_plot(left, right) ? c.same_plots : c.different_plots).push_back(figure.name);
  }
}

/// The figures of both headlines, paired by what they are called.
void compare_figures(Comparison& c, const Headline& a, const Headline& b) {
  for (const Headline::Figure& figure : a.figures)
    c.figures.push_back({figure.label, figure.value, "", figure.exact, ""});
  for (const Headline::Figure& figure : b.figures) {
    auto found = std::find_if(c.figures.begin(), c.figures.end(),
                              [&](const auto& each) { return each.label == figure.label; });
    if (found == c.figures.end()) found = c.figures.insert(found, {figure.label, "", "", "", ""});
    found->b = figure.value;
    found->exact_b = figure.exact;
  }
}

/// "pass, exit 0".
std::string verdict_text(const Headline& headline, const Json& result) {
  const auto code = number_at(result, {"exit", "code"});
  const std::string exit = code ? fmt::format("exit {:g}", *code) : "";
  if (headline.verdict.empty() || exit.empty()) return headline.verdict + exit;
  return headline.verdict + ", " + exit;
}

/// "; the bound is 5.87e-07 deg in A and 0.00205 deg in B", "" without one in both.
std::string bound_text(const Json& a, const Json& b, const Patterns& patterns) {
  if (patterns.bound.empty()) return "";
  const Json *left = at_path(a, patterns.bound), *right = at_path(b, patterns.bound);
  if (left == nullptr || right == nullptr) return "";
  const auto x = number_at(*left, {}), y = number_at(*right, {});
  if (!x || !y) return "";
  const char* const unit = patterns.bound.back() == std::string("yield") ? "" : " deg";
  if (*x == *y) return fmt::format("; the {} is {:.3g}{} in both", patterns.bound_name, *x, unit);
  const auto [text_a, text_b] = told_apart(*x, *y, least_digits);
  return fmt::format("; the {} is {}{} in A and {}{} in B", patterns.bound_name, text_a, unit,
                     text_b, unit);
}

/// A pass is one under its conditions.
std::string conditions_text(const ComparedPart& answers) {
  const bool differ =
      std::any_of(answers.different.begin(), answers.different.end(),
                  [](const Compared& each) { return each.name == "verdict.conditions"; });
  return differ ? "; under other conditions in A than in B" : "";
}

std::string sentence_of(const Comparison& c, const std::string& bound) {
  const std::size_t all = c.answers.count() + c.settings.count() + c.values.count();
  const bool agree = c.verdict_a == c.verdict_b;
  const std::string verdict = c.verdict_a.empty() ? "no verdict" : c.verdict_a;
  if (c.is_same())
    return fmt::format("The two results are the same in all {} values: {}", all, verdict);
  std::string text = agree ? fmt::format("The answers agree: {}", verdict)
                           : fmt::format("The answers differ: {} in A, {} in B", verdict,
                                         c.verdict_b.empty() ? "no verdict" : c.verdict_b);
  text += bound + conditions_text(c.answers) +
          fmt::format(". {} of {} and {} of {} differ", c.settings.different_count(),
                      counted(c.settings.count(), "setting"),
                      c.answers.different_count() + c.values.different_count(),
                      counted(c.answers.count() + c.values.count(), "value"));
  return text;
}

}  // namespace

std::size_t ComparedPart::different_count() const {
  std::size_t count = 0;
  for (const Compared& each : different) count += each.values;
  return count;
}

bool Comparison::is_same() const {
  return answers.different.empty() && settings.different.empty() && values.different.empty() &&
         different_plots.empty();
}

std::string reason_not_compared(const std::vector<ResultFile>& results) {
  if (results.size() != 2)
    return fmt::format("two results are compared, and here are {}", results.size());
  const std::string a = command_of(results[0].json), b = command_of(results[1].json);
  if (a == b) return "";
  return fmt::format("two results of one command are compared, and here is one of {} and one of {}",
                     a, b);
}

std::optional<Comparison> compared(const std::vector<ResultFile>& results) {
  if (!reason_not_compared(results).empty()) return std::nullopt;
  const Json &a = results[0].json, &b = results[1].json;
  const std::string command = command_of(a);
  const Patterns& patterns = patterns_of(command);
  const Headline of_a = headline_of(a), of_b = headline_of(b);
  Comparison c;
  c.label_a = results[0].label;
  c.label_b = results[1].label;
  c.answers.title = "answers";
  c.settings.title = "settings";
  c.values.title = "values";
  c.verdict_a = verdict_text(of_a, a);
  c.verdict_b = verdict_text(of_b, b);
  compare_figures(c, of_a, of_b);
  Comparer(c, patterns, a, b).compare();
  compare_plots(c, a, b);
  c.style = c.verdict_a != c.verdict_b ? "bad" : of_a.style == std::string("good") ? "good" : "odd";
  c.sentence = sentence_of(c, bound_text(a, b, patterns));
  return c;
}

}  // namespace capsoc::report
