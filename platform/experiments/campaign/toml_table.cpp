#include "campaign/toml_table.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/nearest.h"
#include "base/printable.h"

namespace capsoc::campaign {

std::vector<Entry> entries_of(const toml::table& table) {
  std::vector<Entry> entries;
  for (auto&& [key, node] : table) entries.push_back({std::string(key.str()), &node});
  const auto place = [](const Entry& entry) {
    const toml::source_position at = entry.node->source().begin;
    return std::make_tuple(at.line, at.column);
  };
  std::stable_sort(entries.begin(), entries.end(),
                   [&](const Entry& a, const Entry& b) { return place(a) < place(b); });
  return entries;
}

std::optional<std::string> scalar_text(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* number = node.as_floating_point(); number != nullptr && std::isfinite(**number))
    return fmt::format("{}", number->get());
  if (const auto* flag = node.as_boolean()) return std::string(flag->get() ? "true" : "false");
  return std::nullopt;
}

TomlTable::TomlTable(TomlFile& file, const toml::table& table, std::string where,
                     const std::vector<std::string_view>& known)
    : file_(file), table_(table), where_(std::move(where)) {
  if (known.empty()) return;
  for (const Entry& entry : entries_of(table)) {
    if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
    const std::string_view start = std::string_view(entry.key).substr(0, 64);
    file_.fail(*entry.node,
               fmt::format("there is no key '{}' in {}; did you mean {}?", printable(entry.key),
                           where_, nearest_names(start, {known.begin(), known.end()})));
  }
}

void TomlTable::fail(const toml::node& node, std::string_view key, const std::string& wrong) {
  file_.fail(node, fmt::format("'{}' in {} {}", printable(key), where_, wrong));
}

void TomlTable::number(std::string_view key, double& target, double least, double greatest) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const auto value = node->value<double>();
  if (!node->is_number() || !value || !(*value >= least && *value <= greatest))
    return fail(*node, key, fmt::format("is no number from {:g} to {:g}", least, greatest));
  target = *value;
}

void TomlTable::whole(std::string_view key, uint64_t& target, uint64_t least, uint64_t greatest) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const auto* integer = node->as_integer();
  if (integer == nullptr || integer->get() < 0 || static_cast<uint64_t>(integer->get()) < least ||
      static_cast<uint64_t>(integer->get()) > greatest)
    return fail(*node, key, fmt::format("is no whole number from {} to {}", least, greatest));
  target = static_cast<uint64_t>(integer->get());
}

void TomlTable::flag(std::string_view key, bool& target) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) return fail(*node, key, "is neither true nor false");
  target = node->as_boolean()->get();
}

void TomlTable::text(std::string_view key, std::string& target) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (!node->is_string()) return fail(*node, key, "is no text; put it in quotes");
  target = node->as_string()->get();
}

bool TomlTable::pair(std::string_view key, double& a, double& b) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  const toml::array* array = node->as_array();
  const bool two = array != nullptr && array->size() == 2 && array->at(0).is_number() &&
                   array->at(1).is_number();
  if (two) {
    a = array->at(0).value_or(0.0);
    b = array->at(1).value_or(0.0);
    if (std::isfinite(a) && std::isfinite(b) && std::isfinite(b - a)) return true;
  }
  fail(*node, key, "is no list of two numbers; write [least, greatest]");
  return false;
}

const toml::table* TomlTable::table(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return nullptr;
  if (!node->is_table()) fail(*node, key, fmt::format("is no table; write [{}]", key));
  return node->as_table();
}

}  // namespace capsoc::campaign
