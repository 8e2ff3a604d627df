// The coprocessor's ANGLE next to the angle that the CSFN's calibration gives for the same samples.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "identification/identify.h"
#include "metrics/sample_record.h"

namespace capsoc::golden {

/// What the record does not say of the coprocessor and the converter that made it.
struct GoldenSettings {
  bool paper = false;  ///< its arithmetic
  /// Largest and smallest of the steps 2 mu that are not 0; 0: it learns nothing.
  double largest_step = 0, smallest_step = 0;
  double converter_step = 0;  ///< full scale; 0: not known
};

/// By how much two right angles may differ, degrees.
struct AngleTolerance {
  double csfn = 0;    ///< the CSFN's own bound, or what harmonics that it found do to both
  double noise = 0;   ///< what the samples' noise leaves in LMS weights that learn with the step
  double wander = 0;  ///< twice what the parameters moved in the last turn of demodulation
  double arithmetic = 0;  ///< of the coprocessor's words
  double total() const { return csfn + noise + wander + arithmetic; }
};

struct AngleCheck {
  enum class Verdict { not_compared, agrees, disagrees };
  Verdict verdict = Verdict::not_compared;
  /// One sentence unless it agrees.
  std::string reason = "there is no angle to compare";
  bool demodulating = false;         ///< the samples are of demodulation, not of calibration mode
  std::size_t samples = 0;           ///< with an angle, that were compared
  std::optional<double> difference;  ///< largest, degrees; none without samples
  std::optional<AngleTolerance> bound;  ///< with a difference
};

/// Beyond it a difference is one whatever the bound, and a bound guarantees nothing; degrees.
constexpr double widest_bound = 10;

/// "agrees", "disagrees", "not compared".
const char* to_string(AngleCheck::Verdict verdict);

/// Compares ANGLE sample by sample: over the calibration mode at the record's end with unchanged
/// parameters, or, if it ends in demodulation, over its last turn (or 4 / smallest_step samples if
/// that is more). The samples do not tell the direction: it is that of the coprocessor's beta.
/// A sample inside the ellipse counts by its radius. `answer` is not rejected.
AngleCheck compare_angles(const metrics::SampleRecord& record,
                          const identification::Identification& answer,
                          const GoldenSettings& settings);

nlohmann::ordered_json to_json(const AngleCheck& check);
std::string to_table(const AngleCheck& check);

}  // namespace capsoc::golden
