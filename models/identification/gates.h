// Checks that tell a record from which the sensor can be identified from one that only looks so.
#pragma once

#include <string>
#include <vector>

#include "identification/coverage.h"
#include "identification/samples.h"

namespace capsoc::identification {

/// One check of the data or of the answer.
struct Gate {
  std::string name;    ///< "samples", "gap", ... as in the report's keys
  bool passed = true;  ///< also when it could not be applied
  double value = 0;    ///< what was measured
  double limit = 0;    ///< what it was compared with
  std::string reason;  ///< empty when passed, else one sentence: what is wrong, what to do
};

/// A gate that failed for want of anything to measure.
Gate failed_gate(const char* name, std::string reason);

struct GateLimits {
  int64_t samples = 16;  ///< at least
  /// At least this part of the circle, 0..1, and the largest part of it without a sample, at most,
  /// degrees. No limits by themselves: what is missing shows in the bound.
  double coverage = 0, gap = 360;
  double residual = 0.35;  ///< rms of 1 - Y, at most
  double noise = 0.25;     ///< in units of the ellipse's smaller half axis, at most
  double outliers = 0.2;   ///< part of the samples, at most
  /// Largest bound of the angle's error without harmonics, over the part of the turn that the
  /// samples cover, degrees.
  double bound = 30;
  double phase = 1.5;          ///< |beta| at most, radians: beyond, the ellipse is nearly a line
  double magnification = 100;  ///< amplitude at most this many times half the channel's range
  /// Values at or beyond +-full_scale are clipped. 0: not known. A channel whose samples pile up
  /// at their largest or smallest value is found without it.
  double full_scale = 0;
};

/// Checks that need no parameters: "samples" (too few), "finite", "ellipse" (a point, a line, too
/// few different points), "clipping". Ends at the first that makes the later ones meaningless.
/// step: of the converter, unit of the samples; 0: not known.
std::vector<Gate> check_record(const Channel& u, const Channel& v, const GateLimits& limits,
                               double step = 0);

/// Samples that share the largest or the smallest value of a channel (to `resolution`, the
/// converter's step) although their other channel differs, at least two of them: they may be
/// clipped.
struct Plateau {
  std::string name;  ///< "U" or "V"
  bool top = true;
  std::vector<Eigen::Index> places;
};
std::vector<Plateau> plateaus_of(const Channel& u, const Channel& v, double resolution);

/// "plateau": whether the samples of a plateau are on the inner side of the ellipse that the others
/// lie on, together farther than its noise explains.
Gate check_plateau(const Channel& u, const Channel& v, const Plateau& plateau,
                   const Parameters& parameters, double noise, double resolution);

/// Checks of what was identified: "coverage", "gap", "phase", "magnification", "residual".
std::vector<Gate> check_answer(const Channel& u, const Channel& v, const Parameters& parameters,
                               const GateLimits& limits);

}  // namespace capsoc::identification
