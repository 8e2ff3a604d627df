#include "campaign/description.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/input_file.h"
#include "base/printable.h"
#include "campaign/toml_table.h"

namespace capsoc::campaign {
namespace {

constexpr uint64_t largest_file = 1U << 20U;
constexpr uint64_t most_seconds = 1'000'000;
constexpr double longest_session_s = 1e6;

/// It stands in reports, and in the names of a cluster's jobs.
constexpr const char* name_letters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 .-_";

struct Generator {
  const char* word;
  Axis::Kind kind;
};
constexpr Generator generators[] = {
    {"range", Axis::Kind::range},     {"log_range", Axis::Kind::log_range},
    {"uniform", Axis::Kind::uniform}, {"log_uniform", Axis::Kind::log_uniform},
    {"normal", Axis::Kind::normal},   {"integers", Axis::Kind::integers},
    {"seeds", Axis::Kind::seeds},
};

struct CombineWord {
  const char* word;
  AxisGroup::Combine combine;
};
constexpr CombineWord combinations[] = {{"product", AxisGroup::Combine::product},
                                        {"zip", AxisGroup::Combine::zip},
                                        {"independent", AxisGroup::Combine::independent},
                                        {"latin_hypercube", AxisGroup::Combine::latin_hypercube}};

const Generator* generator_of(const toml::table& table) {
  for (const Generator& generator : generators)
    if (table.contains(generator.word)) return &generator;
  return nullptr;
}

/// a * b, or most_runs + 1 for whatever is more than a campaign holds.
uint64_t product(uint64_t a, uint64_t b) {
  return b != 0 && a > most_runs / b ? most_runs + 1 : a * b;
}

class DescriptionReader {
 public:
  DescriptionReader(std::string file, std::string text) : file_{std::move(file), {}} {
    result_.file = file_.name;
    result_.text = std::move(text);
  }

  Result<Description> read() {
    const toml::parse_result parsed = toml::parse(result_.text, file_.name);
    if (!parsed)
      return Error{fmt::format("{}:{}: {}; mend the TOML", file_.name,
                               parsed.error().source().begin.line,
                               printable(parsed.error().description(), 120))};
    read_top(parsed.table());
    if (file_.error) return *file_.error;
    return std::move(result_);
  }

 private:
  void read_top(const toml::table& root) {
    TomlTable top(file_, root, "the description",
                  {"name", "kind", "seed", "least_yield", "worst", "settings", "axes",
                   "repetitions", "derived", "limits", "keep", "metrics", "criteria", "by"});
    top.text("name", result_.name);
    if (result_.name.empty()) file_.fail(root, "the campaign has no name; write name = \"...\"");
    if (result_.name.find_first_not_of(name_letters) != std::string::npos)
      top.fail(*root.get("name"), "name",
               "has more than letters, digits, spaces, '.', '-' and '_'");
    top.text("kind", result_.kind);
    top.whole("seed", result_.seed, 0, std::numeric_limits<int64_t>::max());
    top.number("least_yield", result_.least_yield, 0, 1);
    top.text("worst", result_.worst);
    if (const auto* settings = top.table("settings")) read_settings(*settings, "");
    if (const toml::node* axes = root.get("axes")) read_axes(top, *axes);
    if (const auto* repetitions = top.table("repetitions")) read_repetitions(*repetitions);
    if (const auto* derived = top.table("derived")) read_derived(*derived, "");
    if (const auto* limits = top.table("limits")) read_limits(*limits);
    if (const auto* keep = top.table("keep")) read_keep(*keep);
    if (const auto* metrics = top.table("metrics"))
      read_named(*metrics, "[metrics]", result_.metrics);
    if (const auto* criteria = top.table("criteria"))
      read_named(*criteria, "[criteria]", result_.criteria);
    if (const auto* by = top.table("by")) read_named(*by, "[by]", result_.by);
    if (file_.error) return;
    check_count(root);
    check_paths();
    check_worst(root);
  }

  /// The first group with which the campaign is too large.
  void check_count(const toml::table& root) {
    uint64_t runs = 1;
    for (const AxisGroup& group : result_.groups) {
      runs = product(runs, group.runs);
      if (runs > most_runs) return too_many(group.axes.front().origin);
    }
    if (product(runs, result_.repetitions) > most_runs)
      too_many(file_.place(*root.get("repetitions")));
  }
  void too_many(const std::string& origin) {
    if (!file_.error)
      file_.error = Error{fmt::format(
          "{}: with this the campaign has more than {} runs; take fewer values, or draw a sample "
          "(combine = \"latin_hypercube\")",
          origin, most_runs)};
  }

  /// A setting has one source.
  void check_paths() {
    std::vector<std::pair<std::string, std::string>> seen;  // path, origin
    const auto look = [&](const std::string& path, const std::string& origin) {
      for (const auto& [known, where] : seen)
        if (known == path && !file_.error)
          file_.error = Error{fmt::format("{}: '{}' has values in {} already; keep one of them",
                                          origin, printable(path), where)};
      seen.emplace_back(path, origin);
    };
    for (const AxisGroup& group : result_.groups)
      for (const Axis& axis : group.axes) look(axis.path, axis.origin);
    for (const Assignment& seed : result_.repetition_seeds) look(seed.path, seed.origin);
    for (const Named& derived : result_.derived) look(derived.name, derived.origin);
  }

  void check_worst(const toml::table& root) {
    if (result_.worst.empty()) return;
    for (const Named& metric : result_.metrics)
      if (metric.name == result_.worst) return;
    file_.fail(*root.get("worst"), fmt::format("[metrics] has no '{}'; name one of its keys",
                                               printable(result_.worst)));
  }

  void read_settings(const toml::table& table, const std::string& prefix) {
    for (const Entry& entry : entries_of(table)) {
      const std::string path = prefix + entry.key;
      if (const toml::table* inner = entry.node->as_table()) {
        read_settings(*inner, path + ".");
      } else if (const auto value = scalar_text(*entry.node)) {
        result_.settings.push_back({path, *value, file_.place(*entry.node)});
      } else {
        file_.fail(*entry.node,
                   fmt::format("{} must be a text, a number or true/false; several values make an "
                               "axis, in [[axes]]",
                               printable(path)));
      }
    }
  }

  void read_axes(TomlTable& top, const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr) return top.fail(node, "axes", "is no list of tables; write [[axes]]");
    for (const toml::node& element : *array) {
      const toml::table* table = element.as_table();
      if (table == nullptr) return top.fail(element, "axes", "has more than tables");
      read_group(*table);
    }
  }

  void read_group(const toml::table& table) {
    AxisGroup group;
    TomlTable in(file_, table, "[[axes]]");
    std::string word = combinations[0].word;
    in.text("combine", word);
    bool known = false;
    for (const CombineWord& each : combinations) {
      if (word != each.word) continue;
      group.combine = each.combine;
      known = true;
    }
    if (!known)
      in.fail(*table.get("combine"), "combine",
              "is none of product, zip, independent, latin_hypercube");
    if (group.is_sample() && table.get("runs") == nullptr)
      file_.fail(table, fmt::format("combine = \"{}\" needs runs = N", word));
    if (!group.is_sample() && table.get("runs") != nullptr)
      in.fail(*table.get("runs"), "runs", "belongs to a sample; give combine, too");
    in.whole("runs", group.runs, 1, most_runs);
    read_axes_of(table, "", group);
    if (group.axes.empty())
      file_.fail(table, "[[axes]] has no axis; name a setting and its values");
    if (!file_.error) count_runs(group);
    result_.groups.push_back(std::move(group));
  }

  void read_axes_of(const toml::table& table, const std::string& prefix, AxisGroup& group) {
    for (const Entry& entry : entries_of(table)) {
      if (prefix.empty() && (entry.key == "combine" || entry.key == "runs")) continue;
      const std::string path = prefix + entry.key;
      const toml::table* inner = entry.node->as_table();
      const Generator* generator = inner != nullptr ? generator_of(*inner) : nullptr;
      if (inner != nullptr && generator == nullptr) {
        if (inner->empty()) empty_axis(*entry.node, path);
        read_axes_of(*inner, path + ".", group);
        continue;
      }
      Axis axis;
      axis.path = path;
      axis.origin = file_.place(*entry.node);
      if (generator != nullptr)
        read_generator(*inner, *generator, group, axis);
      else
        read_list(*entry.node, axis);
      group.axes.push_back(std::move(axis));
    }
  }

  void empty_axis(const toml::node& node, const std::string& path) {
    file_.fail(node, fmt::format("the axis '{}' is empty; give it a value", printable(path)));
  }

  void read_list(const toml::node& node, Axis& axis) {
    const toml::array* array = node.as_array();
    if (array == nullptr)
      return file_.fail(node, fmt::format("'{}' has one value; write it in [settings], or a list, "
                                          "range, log_range, uniform, log_uniform, normal, "
                                          "integers or seeds",
                                          printable(axis.path)));
    if (array->empty()) return empty_axis(node, axis.path);
    for (const toml::node& element : *array) {
      const auto value = scalar_text(element);
      if (!value)
        return file_.fail(element, fmt::format("'{}' has a value that is no text, no finite number "
                                               "and not true/false",
                                               printable(axis.path)));
      axis.values.push_back(*value);
    }
    axis.count = axis.values.size();
  }

  void read_generator(const toml::table& table, const Generator& generator, const AxisGroup& group,
                      Axis& axis) {
    axis.kind = generator.kind;
    axis.least = -std::numeric_limits<double>::infinity();
    axis.greatest = -axis.least;
    const bool points = !axis.is_drawn();
    std::vector<std::string_view> known = {generator.word};
    if (points) known.emplace_back("points");
    if (!points && !group.is_sample()) known.emplace_back("count");
    if (axis.kind == Axis::Kind::normal) known.insert(known.end(), {"least", "greatest"});
    TomlTable in(file_, table, fmt::format("the axis '{}'", printable(axis.path)), known);
    constexpr double largest = 1e300;
    if (axis.kind == Axis::Kind::seeds) {
      bool yes = false;
      in.flag("seeds", yes);
      if (!yes) in.fail(table, "seeds", "can only be true");
    } else {
      in.pair(generator.word, axis.a, axis.b);
    }
    in.number("least", axis.least, -largest, largest);
    in.number("greatest", axis.greatest, -largest, largest);
    in.whole(points ? "points" : "count", axis.count, points ? 2 : 1, most_runs);
    if (axis.count == 0 && !group.is_sample())
      file_.fail(table, fmt::format("the axis '{}' is empty; give it {} = N", printable(axis.path),
                                    points ? "points" : "count"));
    if (points && axis.count == 0)
      file_.fail(table, fmt::format("the axis '{}' needs points = N", printable(axis.path)));
    check_numbers(table, in, generator.word, axis);
  }

  void check_numbers(const toml::table& table, TomlTable& in, const char* word, const Axis& axis) {
    const auto fail = [&](const char* wrong) { in.fail(table, word, wrong); };
    switch (axis.kind) {
      case Axis::Kind::log_range:
      case Axis::Kind::log_uniform:
        if (!(axis.a > 0 && axis.b > 0 && std::isfinite(axis.b / axis.a)))
          fail("has no logarithm; give two positive numbers");
        break;
      case Axis::Kind::normal:
        if (!(axis.b > 0)) fail("is [mean, standard deviation]; the latter is above 0");
        if (!(axis.least < axis.greatest)) fail("has least that is not below greatest");
        // Beyond, nearly nothing would be drawn, and that badly.
        if (axis.least > axis.a + 6 * axis.b || axis.greatest < axis.a - 6 * axis.b)
          fail("lies outside least and greatest");
        break;
      case Axis::Kind::integers:
        if (axis.a != std::floor(axis.a) || axis.b != std::floor(axis.b) || axis.a > axis.b ||
            std::fabs(axis.a) > 0x1p52 || std::fabs(axis.b) > 0x1p52)
          fail("is no list of two whole numbers, the lesser one first");
        break;
      default:
        break;
    }
  }

  void count_runs(AxisGroup& group) {
    if (group.is_sample()) return;
    if (group.combine == AxisGroup::Combine::product) {
      group.runs = 1;
      for (const Axis& axis : group.axes) group.runs = product(group.runs, axis.count);
      return;
    }
    group.runs = group.axes.front().count;
    for (const Axis& axis : group.axes)
      if (axis.count != group.runs && !file_.error)
        file_.error = Error{fmt::format(
            "{}: '{}' has {} values and '{}' {}; axes of a zip have as many", axis.origin,
            printable(axis.path), axis.count, printable(group.axes.front().path), group.runs)};
  }

  void read_repetitions(const toml::table& table) {
    TomlTable in(file_, table, "[repetitions]", {"count", "seeds"});
    in.whole("count", result_.repetitions, 1, most_runs);
    const toml::node* seeds = table.get("seeds");
    const toml::array* array = seeds != nullptr ? seeds->as_array() : nullptr;
    if (array == nullptr || array->empty())
      return file_.fail(seeds != nullptr ? *seeds : static_cast<const toml::node&>(table),
                        "[repetitions] needs seeds = [\"sensor.noise.seed\", ...]: a repetition "
                        "with the same seeds would be the same run");
    for (const toml::node& element : *array) {
      if (!element.is_string()) return in.fail(element, "seeds", "has more than names of settings");
      result_.repetition_seeds.push_back({element.as_string()->get(), "", file_.place(element)});
    }
  }

  void read_derived(const toml::table& table, const std::string& prefix) {
    for (const Entry& entry : entries_of(table)) {
      const std::string path = prefix + entry.key;
      if (const toml::table* inner = entry.node->as_table())
        read_derived(*inner, path + ".");
      else
        read_expression(*entry.node, path, "[derived]", result_.derived);
    }
  }

  void read_named(const toml::table& table, const char* where, std::vector<Named>& target) {
    for (const Entry& entry : entries_of(table))
      read_expression(*entry.node, entry.key, where, target);
  }

  void read_expression(const toml::node& node, const std::string& name, const char* where,
                       std::vector<Named>& target) {
    if (!node.is_string())
      return file_.fail(node, fmt::format("'{}' in {} is no text; write the expression in quotes",
                                          printable(name), where));
    auto expression = Expression::parse(node.as_string()->get());
    if (!expression)
      return file_.fail(node,
                        fmt::format("'{}' in {}: {}", printable(name), where, expression.error()));
    target.push_back({name, std::move(expression.value()), file_.place(node)});
  }

  void read_limits(const toml::table& table) {
    TomlTable in(file_, table, "[limits]", {"seconds", "memory_mib"});
    in.number("seconds", result_.limits.seconds, 0.01, static_cast<double>(most_seconds));
    in.whole("memory_mib", result_.limits.memory_mib, 16, 1U << 24U);
  }

  void read_keep(const toml::table& table) {
    TomlTable in(file_, table, "[keep]", {"failures", "waves", "session_s"});
    in.text("failures", result_.failures_folder);
    in.flag("waves", result_.failures_waves);
    if (table.contains("session_s"))
      in.number("session_s", result_.session_s.emplace(), 0, longest_session_s);
    if (result_.failures_folder.empty())
      file_.fail(table, "[keep] needs failures = \"FOLDER\": where the files of failed runs go");
  }

  TomlFile file_;
  Description result_;
};

}  // namespace

uint64_t Description::runs() const {
  uint64_t runs = repetitions;
  for (const AxisGroup& group : groups) runs *= group.runs;
  return runs;
}

std::vector<std::string> Description::axis_paths() const {
  std::vector<std::string> paths;
  for (const AxisGroup& group : groups)
    for (const Axis& axis : group.axes) paths.push_back(axis.path);
  for (const Assignment& seeds : repetition_seeds) paths.push_back(seeds.path);
  return paths;
}

Result<Description> read_description(const std::string& file) {
  auto text = read_input(file, {"name the description of a campaign (TOML)", largest_file});
  if (!text) return Error{text.error()};
  return read_description(text.value(), file);
}

Result<Description> read_description(const std::string& text, const std::string& file) {
  return DescriptionReader(file, text).read();
}

}  // namespace capsoc::campaign
