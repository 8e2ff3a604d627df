// The closed-form fits next to an answer: what a training must reach, and how far fits differ.
#pragma once

#include "identification/identification.h"

namespace capsoc::identification {
/// Losses below are rounding: 1 - Y of a dozen operations, squared.
inline constexpr double rounding_loss = 1e-24;
/// A training is not at its end when an ellipse fit has a loss this much lower.
inline constexpr double worse_loss = 1.05;

/// The largest of the differences, in units that make them comparable: amplitudes and offsets by
/// the amplitude of `other`, beta in radians.
double difference_of(const Parameters& one, const Parameters& other);

/// Heydemann's, Taubin's and the direct fit; none of samples that have no moments.
std::vector<Companion> companions_of(const Samples& samples);

/// The companion with the smallest loss; nullptr when none has one.
const Companion* best_of(const std::vector<Companion>& companions);

/// A training that ended above this loss did not end in the minimum.
double floor_of(const Companion& best);

}  // namespace capsoc::identification
