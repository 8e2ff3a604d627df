// Keys from outside laid over a parsed description.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/toml.h"
#include "sensor/description_keys.h"

namespace capsoc::sensor {

/// Changes the table and remembers which nodes came from outside, so that an error in one names its
/// origin and not a line of the file.
class Overrides {
 public:
  /// A key of another kind of motion or of the other kind of noise goes when its kind goes.
  std::optional<Error> apply(toml::table& root, const std::vector<KeyValue>& values);

  /// The origin of a node from outside, null for one of the file.
  const std::string* origin_of(const toml::node& node) const;

 private:
  using Names = std::vector<std::string>;

  std::optional<Error> apply_key(toml::table& root, const DescriptionKey& key,
                                 const KeyValue& value);
  std::optional<Error> apply_harmonic(toml::table& root, const KeyValue& value);
  toml::table* table_of(toml::table& root, const std::string& name, const KeyValue& value);
  void put(toml::table& table, const std::string& key, DescriptionKey::Kind kind,
           const KeyValue& value);
  void drop_foreign_motion(toml::table& root, const Names& set) const;

  std::map<const toml::node*, std::string> origins_;
};

}  // namespace capsoc::sensor
