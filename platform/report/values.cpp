#include "report/values.h"

#include <algorithm>
#include <set>
#include <utility>

#include "base/ends_with.h"

namespace capsoc::report {
namespace {

constexpr const char* left_out[] = {"curves", "time.wall_s", "cpu.mips", "wall_s"};

/// By these an element of a list is found again, the first that it has.
constexpr const char* names_of_elements[] = {
    "id",     "name", "role",  "quantity", "program", "scenario", "function",
    "method", "node", "fault", "run",      "exit",    "value",    "number"};

/// These have no unit, whatever they are of.
constexpr const char* plain_numbers[] = {"count", "missing",    "share", "chance", "correlation",
                                         "runs",  "confidence", "met",   "samples"};

/// By the end of a key, the innermost first.
std::string unit_by_key(const std::vector<std::string>& keys) {
  if (std::find(std::begin(plain_numbers), std::end(plain_numbers), keys.back()) !=
      std::end(plain_numbers))
    return "";
  static constexpr std::pair<const char*, const char*> units[] = {
      {"_deg", "deg"},  {"_rad", "rad"},        {"_hz", "Hz"}, {"_ns", "ns"},
      {"mips", "MIPS"}, {"mips_least", "MIPS"}, {"_s", "s"}};
  for (auto key = keys.rbegin(); key != keys.rend(); ++key)
    for (const auto& [end, unit] : units)
      if (ends_with(*key, end)) return unit;
  return "";
}

/// The values of a parameter, whose words have none.
std::string unit_of_parameter(const std::vector<std::string>& keys) {
  if (keys.size() != 3 || keys.front() != "parameters") return "";
  if (keys[2] != "value" && keys[2] != "true" && keys[2] != "interval") return "";
  return keys[1] == "beta" || keys[1] == "phi" ? "rad" : "full scale";
}

class Walk {
 public:
  std::vector<Value> all;

  void follow(const Json& json, const std::string& unit) {
    if (is_left_out()) return;
    if (json.is_object()) {
      const std::string own = text_at(json, {"unit"});
      for (const auto& [key, value] : json.items()) enter(key, value, own.empty() ? unit : own);
    } else if (json.is_array() && has_structure(json)) {
      std::size_t place = 0;
      for (const Json& element : json) enter(name_of(element, ++place), element, unit);
    } else {
      add(json, unit);
    }
  }

 private:
  bool is_left_out() const {
    return std::any_of(std::begin(left_out), std::end(left_out),
                       [&](const char* pattern) { return matches(keys_, pattern); });
  }

  static bool has_structure(const Json& list) {
    return std::any_of(list.begin(), list.end(),
                       [](const Json& element) { return element.is_structured(); });
  }

  static std::string name_of(const Json& element, std::size_t place) {
    for (const char* field : names_of_elements) {
      const Json* found = find(element, {field});
      if (found == nullptr || found->is_structured() || found->is_null()) continue;
      const std::string seed = shown_at(element, {"seed"});
      // A number alone would not say what it is of.
      return (found->is_string() ? "" : std::string(field) + " ") + shown_at(*found, {}) +
             (seed == "-" ? "" : " seed " + seed);
    }
    return std::to_string(place);
  }

  void enter(const std::string& key, const Json& value, const std::string& unit) {
    keys_.push_back(key);
    follow(value, unit);
    keys_.pop_back();
  }

  void add(const Json& json, const std::string& unit) {
    Value value{keys_, &json, ""};
    // Elements of the same name are told apart by a number.
    for (int again = 2; !names_.insert(value.name()).second; ++again)
      value.keys.back() = keys_.back() + " #" + std::to_string(again);
    if (json.is_number()) {
      value.unit = unit_of_parameter(keys_);
      if (value.unit.empty()) value.unit = unit_by_key(keys_);
      if (value.unit.empty()) value.unit = unit;
    }
    all.push_back(std::move(value));
  }

  std::vector<std::string> keys_;
  std::set<std::string> names_;
};

}  // namespace

std::string Value::name(std::size_t depth) const {
  std::string text;
  for (std::size_t i = 0; i < depth; ++i) text += (i == 0 ? "" : ".") + keys[i];
  return text;
}

std::vector<Value> values_of(const Json& result) {
  Walk walk;
  walk.follow(result, "");
  return std::move(walk.all);
}

bool matches(const std::vector<std::string>& keys, const char* pattern) {
  const std::string whole = pattern;
  std::size_t at = 0;
  for (const std::string& key : keys) {
    const std::size_t end = std::min(whole.find('.', at), whole.size());
    const std::string part = whole.substr(at, end - at);
    if (part != "*" && part != key) return false;
    if (end == whole.size()) return true;
    at = end + 1;
  }
  return false;
}

}  // namespace capsoc::report
