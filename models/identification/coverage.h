// How samples lie on the circle.
#pragma once

#include <bitset>

#include "identification/samples.h"

namespace capsoc::identification {

struct Coverage {
  double part = 0;         ///< of the circle that is covered, 0..1
  double largest_gap = 0;  ///< degrees
  std::bitset<360>
      degrees;  ///< that are covered, by Eq (4)'s angle; gaps of the samples' spacing are

  /// Whether an angle (radians) is covered.
  bool has(double theta) const;
  /// Of samples all over the turn.
  static Coverage whole();
};
Coverage coverage_of(const Channel& u, const Channel& v, const Parameters& parameters);

}  // namespace capsoc::identification
