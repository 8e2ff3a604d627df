// A result as names and values: the keys of nested objects joined by dots, elements of lists by
// their number ("inputs.0.path").
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "campaign/expression.h"

namespace capsoc::campaign {

using FlatResult = std::map<std::string, Value>;

FlatResult flatten(const nlohmann::ordered_json& json);

/// Whether `name` is one of `keys` or below one.
bool is_below(const std::string& name, const std::vector<std::string>& keys);

}  // namespace capsoc::campaign
