// The golden check: what the SoC identified on line next to what the CSFN finds in the same
// samples.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "golden/golden_angle.h"
#include "metrics/metrics.h"
#include "metrics/sample_record.h"

namespace capsoc::golden {

/// One parameter from both sides, in the registers' words.
struct GoldenRow {
  std::string name;
  int64_t soc = 0;
  int64_t csfn = 0;
  int64_t difference = 0;  ///< soc - csfn in units of the last place, angles modulo a turn
  double interval = 0;     ///< half width of the CSFN's confidence interval, in the same units
};

/// Both answers on one record. The words of the SoC are made canonical first
/// (identification/calibration.h): the samples alone do not tell beta from pi - beta turned the
/// other way round.
struct Golden {
  std::size_t samples = 0;
  std::string rejection;  ///< why the CSFN has no answer; empty: it has
  std::vector<GoldenRow> rows;
  /// Largest difference of the two calibrated angles over a turn of the CSFN's curve, 2^-32 turn;
  /// nothing when they run opposite ways or an answer is no ellipse.
  std::optional<double> angle_difference;
  identification::Method method = identification::Method::levenberg_marquardt;
  std::string stop_reason;  ///< why the CSFN's training ended
  int iterations = 0;
  double confidence = 0;
  AngleCheck angle;  ///< with a rejection: its reason, nothing compared
};

/// Fits the samples by Levenberg-Marquardt on the network's residual or, where that is refused, by
/// their distances. phi is no part of it: samples
/// without their angles do not tell it.
Golden compare(const metrics::SampleRecord& samples, const metrics::ParameterWords& soc,
               const GoldenSettings& settings);

nlohmann::ordered_json to_json(const Golden& golden);
std::string to_table(const Golden& golden);

}  // namespace capsoc::golden
