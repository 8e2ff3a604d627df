// What a regression found, for people, for programs and for continuous integration.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "regress/campaign.h"
#include "regress/rtl_coverage.h"

namespace capsoc::regress {

/// Counts of each scenario, coverage with what is missing, and the first difference if there is
/// one.
std::string to_text(const Plan& plan, const Outcome& outcome, const std::vector<RtlCoverage>& rtl);

/// The same and every run and bin. The same seeds give the same bytes.
nlohmann::ordered_json to_json(const Plan& plan, const Outcome& outcome,
                               const std::vector<RtlCoverage>& rtl);

/// JUnit: a test suite for each arithmetic, a test case for each run.
std::string to_junit(const Outcome& outcome);

}  // namespace capsoc::regress
