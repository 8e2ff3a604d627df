// What a fit has to say: the calibration file, the header for the firmware, and text for a person.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "fit/fit.h"

namespace capsoc::fit {

/// calibration.json; its keys are documented in docs/reference/results.md. `versions` and `command`
/// go in as they are. Only of a fit that was not rejected.
nlohmann::ordered_json to_json(const Fit& fit, const nlohmann::ordered_json& versions,
                               const std::string& command);

/// calibration.h: the words as C macros, for firmware/apps/common/parameter_block.h.
std::string to_header(const Fit& fit);

/// Iteration, loss and parameters, one row a point; without a trace only the heading.
std::string to_convergence(const Fit& fit);

std::string to_table(const Fit& fit);

}  // namespace capsoc::fit
