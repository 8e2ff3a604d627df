#include "campaign/flat.h"

#include <cmath>

namespace capsoc::campaign {
namespace {

Value scalar_of(const nlohmann::ordered_json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number()) {
    const double number = json.get<double>();
    if (std::isfinite(number)) return number;
  }
  return {};
}

constexpr int deepest_result = 32;  // a damaged store may hold anything

void add(const nlohmann::ordered_json& json, const std::string& name, int depth, FlatResult& flat) {
  if (!json.is_structured()) {
    flat[name] = scalar_of(json);
    return;
  }
  if (depth == deepest_result) return;
  const std::string prefix = name.empty() ? "" : name + ".";
  std::size_t number = 0;
  for (const auto& [key, value] : json.items())
    add(value, prefix + (json.is_array() ? std::to_string(number++) : key), depth + 1, flat);
}

}  // namespace

FlatResult flatten(const nlohmann::ordered_json& json) {
  FlatResult flat;
  add(json, "", 0, flat);
  return flat;
}

bool is_below(const std::string& name, const std::vector<std::string>& keys) {
  for (const std::string& key : keys)
    if (name.compare(0, key.size(), key) == 0 &&
        (name.size() == key.size() || name[key.size()] == '.'))
      return true;
  return false;
}

}  // namespace capsoc::campaign
