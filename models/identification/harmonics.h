// The second and third harmonics of both channels, without a reference angle.
// docs/explanation/harmonics.md says what can be known of them and what each assumption costs.
#pragma once

#include <string>

#include "base/result.h"
#include "identification/calibration.h"

namespace capsoc::identification {

/// What tells harmonics of the sensor from an uneven motion of the shaft.
enum class Assumption {
  automatic,       ///< the first of those below (but `symmetric`) that the data bears out
  constant_speed,  ///< samples in order of time, the shaft turning steadily
  even_coverage,   ///< samples in any order, spread evenly over whole turns
  symmetric,       ///< both channels have the same waveform, V being U a quarter turn + beta later
  shape,           ///< nothing: the curve alone, only for noise below 1e-5 of the amplitude
  none,            ///< (an answer, not a request) no harmonics were identified
};

/// "automatic", "constant speed", "even coverage", "symmetric channels", "shape alone", "none".
const char* to_string(Assumption assumption);

struct HarmonicsOptions {
  int highest = 0;  ///< 0 or 1: none, 2: the second, 3: the second and the third
  Assumption assumption = Assumption::automatic;
};

struct Harmonics {
  bool identified = false;
  Assumption used = Assumption::none;
  /// One sentence each: why this assumption was used, or none could be; and for every one that was
  /// tried and failed, why.
  std::string reason;
  SignalModel model;  ///< without harmonics when none were identified
  /// What the check of the assumption measured and the limit it was compared with; what they are is
  /// in check.
  std::string check;
  double check_value = 0;
  double check_limit = 0;
  double noise = 0;  ///< rms distance of the samples from the curve, in the unit of the samples
  /// Peak-to-peak error of the angle, radians, that the noise and the spread of the angles leave
  /// to be expected (median). 0 when none were identified.
  double expected_error = 0;
  /// The share of expected_error that is due to the finite number of angles: even_coverage of
  /// randomly drawn angles is limited by it. 0 otherwise.
  double coverage_error = 0;
  /// Why the model does not guarantee any angle although it was identified, or "".
  std::string unbounded;
};

/// Extends `start`, the ellipse that was identified from the same samples. Error: options out of
/// range, or samples that check_samples() refuses. An assumption that does not hold is no error:
/// the answer then is `start` with a reason.
Result<Harmonics> identify_harmonics(const Channel& u, const Channel& v, const Parameters& start,
                                     const HarmonicsOptions& options);

}  // namespace capsoc::identification
