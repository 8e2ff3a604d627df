#pragma once

#include <nlohmann/json.hpp>
#include <optional>

namespace capsoc {

/// A figure that may be unknown, as result files have it.
inline nlohmann::ordered_json number_or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace capsoc
