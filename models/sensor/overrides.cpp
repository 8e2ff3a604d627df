#include "sensor/overrides.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "base/nearest.h"
#include "base/printable.h"

namespace capsoc::sensor {
namespace {

std::optional<double> number_of(const std::string& text) {
  const char* end = text.data() + text.size();
  double value = 0;
  const auto [last, status] = std::from_chars(text.data(), end, value);
  if (status != std::errc() || last != end) return std::nullopt;
  return value;
}

std::optional<int64_t> integer_of(const std::string& text) {
  const char* end = text.data() + text.size();
  int64_t value = 0;
  const auto [last, status] = std::from_chars(text.data(), end, value);
  if (status == std::errc() && last == end) return value;
  const auto number = number_of(text);  // 1e5
  if (!number || std::floor(*number) != *number || std::fabs(*number) > 9e15) return std::nullopt;
  return static_cast<int64_t>(*number);
}

std::optional<toml::array> list_of(const std::string& text) {
  const toml::parse_result parsed = toml::parse("list = " + text);
  if (!parsed || parsed.table().size() != 1) return std::nullopt;
  const toml::array* list = parsed.table()["list"].as_array();
  return list != nullptr ? std::optional(*list) : std::nullopt;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "u3_amplitude" taken apart.
struct HarmonicKey {
  std::string channel, key;
  int64_t order = 0;
};

std::optional<HarmonicKey> harmonic_key(const std::string& name) {
  const std::size_t underscore = name.find('_');
  if (underscore == std::string::npos || underscore < 2 || underscore > 5) return std::nullopt;
  HarmonicKey found{name.substr(0, 1), name.substr(underscore + 1)};
  const auto order = integer_of(name.substr(1, underscore - 1));
  if ((found.channel != "u" && found.channel != "v") || !order || *order < 0) return std::nullopt;
  if (found.key != "amplitude" && found.key != "phase_rad") return std::nullopt;
  found.order = *order;
  return found;
}

bool is_harmonic(const toml::table& table, const HarmonicKey& wanted) {
  return table["channel"].value_or(std::string()) == wanted.channel &&
         table["order"].value_or(int64_t{0}) == wanted.order;
}

}  // namespace

const std::string* Overrides::origin_of(const toml::node& node) const {
  const auto found = origins_.find(&node);
  return found == origins_.end() ? nullptr : &found->second;
}

std::optional<Error> Overrides::apply(toml::table& root, const std::vector<KeyValue>& values) {
  Names set, known;
  for (const KeyValue& value : values)
    if (!value.value.empty()) set.push_back(value.name);
  for (const DescriptionKey& key : description_keys()) known.push_back(key.name());
  if (toml::table* noise = root["noise"].as_table()) {
    if (contains(set, "noise.sigma"))
      for (const char* key : {"peak", "record_samples"}) noise->erase(key);
    if (contains(set, "noise.peak")) noise->erase("sigma");
  }
  if (toml::table* drift = root["drift"].as_table()) {
    if (contains(set, "drift.period_s")) drift->erase("until_s");
    if (contains(set, "drift.until_s")) drift->erase("period_s");
  }
  if (contains(set, "motion.kind"))
    for (const KeyValue& value : values)
      if (value.name == "motion.kind") drop_foreign_motion(root, {value.value});
  for (const KeyValue& value : values) {
    if (value.name.rfind(harmonics_prefix, 0) == 0) {
      if (auto error = apply_harmonic(root, value)) return error;
      continue;
    }
    const auto& keys = description_keys();
    const auto key = std::find_if(keys.begin(), keys.end(),
                                  [&](const DescriptionKey& k) { return k.name() == value.name; });
    if (key == keys.end())
      return Error{fmt::format("{}: a description has no key '{}'; the nearest are {}",
                               value.origin, printable(value.name),
                               nearest_names(value.name.substr(0, 64), known))};
    if (auto error = apply_key(root, *key, value)) return error;
  }
  return std::nullopt;
}

/// Keys of the file that the new kind does not have describe another motion.
void Overrides::drop_foreign_motion(toml::table& root, const Names& kind) const {
  toml::table* motion = root["motion"].as_table();
  const auto wanted = motion_kind(kind.front());
  if (motion == nullptr || !wanted) return;
  const Names legal = motion_keys(*wanted);
  Names foreign;
  for (const auto& [key, node] : *motion)
    if (!contains(legal, std::string(key.str()))) foreign.emplace_back(key.str());
  for (const std::string& key : foreign) motion->erase(key);
}

/// Null where the file has something else of that name, which the reader refuses.
toml::table* Overrides::table_of(toml::table& root, const std::string& name,
                                 const KeyValue& value) {
  if (name.empty()) return &root;
  if (!root.contains(name)) {
    root.insert(name, toml::table{});
    origins_[root.get(name)] = value.origin;
  }
  return root[name].as_table();
}

/// What is no number or list stays a text, which the reader refuses as it does in a file.
void Overrides::put(toml::table& table, const std::string& key, DescriptionKey::Kind kind,
                    const KeyValue& value) {
  const auto number = number_of(value.value);
  const auto integer = integer_of(value.value);
  if (kind == DescriptionKey::Kind::number && number)
    table.insert_or_assign(key, *number);
  else if (kind == DescriptionKey::Kind::integer && integer)
    table.insert_or_assign(key, *integer);
  else if (const auto list = list_of(value.value); kind == DescriptionKey::Kind::list && list)
    table.insert_or_assign(key, *list);
  else
    table.insert_or_assign(key, value.value);
  const toml::node* node = table.get(key);
  origins_[node] = value.origin;
  if (const toml::array* list = node->as_array())
    for (const toml::node& element : *list) origins_[&element] = value.origin;
}

std::optional<Error> Overrides::apply_key(toml::table& root, const DescriptionKey& key,
                                          const KeyValue& value) {
  if (value.value.empty()) {
    toml::table* table = *key.table == '\0' ? &root : root[key.table].as_table();
    if (table == nullptr) return std::nullopt;
    table->erase(key.key);
    if (table->empty() && table != &root) root.erase(key.table);
    return std::nullopt;
  }
  if (toml::table* table = table_of(root, key.table, value)) put(*table, key.key, key.kind, value);
  return std::nullopt;
}

std::optional<Error> Overrides::apply_harmonic(toml::table& root, const KeyValue& value) {
  const auto wanted = harmonic_key(value.name.substr(std::strlen(harmonics_prefix)));
  if (!wanted)
    return Error{
        fmt::format("{}: a harmonic is named by channel and order, u3_amplitude or "
                    "v12_phase_rad",
                    value.origin)};
  if (!root.contains("harmonics")) root.insert("harmonics", toml::array{});
  toml::array* all = root["harmonics"].as_array();
  if (all == nullptr) return std::nullopt;  // the reader refuses it
  toml::table* found = nullptr;
  for (std::size_t i = 0; i < all->size(); ++i) {
    toml::table* table = (*all)[i].as_table();
    if (table == nullptr || !is_harmonic(*table, *wanted)) continue;
    if (found != nullptr)
      return Error{
          fmt::format("{}: the description has more than one harmonic of this channel and "
                      "order; edit it",
                      value.origin)};
    found = table;
    if (value.value.empty() && wanted->key == "amplitude") {
      all->erase(all->begin() + static_cast<std::ptrdiff_t>(i));
      return std::nullopt;
    }
  }
  if (value.value.empty()) {
    if (found != nullptr) found->erase(wanted->key);
    return std::nullopt;
  }
  if (found == nullptr) {
    all->push_back(toml::table{});
    found = (*all)[all->size() - 1].as_table();
    origins_[found] = value.origin;
    put(*found, "channel", DescriptionKey::Kind::text, {"", wanted->channel, value.origin});
    put(*found, "order", DescriptionKey::Kind::integer,
        {"", std::to_string(wanted->order), value.origin});
  }
  put(*found, wanted->key, DescriptionKey::Kind::number, value);
  return std::nullopt;
}

}  // namespace capsoc::sensor
