// From samples to angles: Eq (4) of the CSFN paper, the model with harmonics, and the angle error.
#pragma once

#include <array>

#include "identification/samples.h"

namespace capsoc::identification {

/// sine * sin(h theta) + cosine * cos(h theta), in units of the channel's amplitude.
struct HarmonicTerm {
  double sine = 0;
  double cosine = 0;
};

/// U = b1 + a1 (sin(theta) + sum of u[h]), V = b2 + a2 (cos(theta + beta) + sum of v[h]) with h = 2
/// (index 0) and h = 3 (index 1). All terms 0: Eq (3).
struct SignalModel {
  Parameters fundamental;
  std::array<HarmonicTerm, 2> u{};
  std::array<HarmonicTerm, 2> v{};
};

/// One sample, or a derivative of it, in the unit of the samples.
struct Point {
  double u = 0;
  double v = 0;
};

/// The sample at the angle theta (radians), and its derivative by theta.
Point point_at(const SignalModel& model, double theta);
Point tangent_at(const SignalModel& model, double theta);

/// Canonical parameters and how the angle runs in them.
struct Canonical {
  Parameters parameters;  ///< a1, a2 > 0, |beta| <= pi/2
  /// theta of the canonical parameters is pi - theta of the given ones (pi + theta or -theta where
  /// an amplitude was negative): it runs the other way round.
  bool reversed = false;
};

/// beta = 3.0796 turned one way round is the ellipse of beta = pi - 3.0796 = 0.0620 turned the
/// other way round; both have the same canonical parameters. beta in radians, any branch.
Canonical canonical(const Parameters& parameters);

/// theta in (-pi, pi] from one sample, Eq (4). The paper's second line misses parentheses and
/// divisors: V_cos = (V - b2)/(a2 cos(beta)) + (U - b1) tan(beta)/a1. Not for cos(beta) = 0.
double angle_of(const Parameters& parameters, double u, double v);

/// theta in (-pi, pi] of the point of the curve that is nearest to the sample, by Newton's method
/// from Eq (4). Without harmonics it is not Eq (4)'s angle when the sample is off the curve.
double angle_of(const SignalModel& model, double u, double v);

/// What an uncalibrated sensor gives: atan2(U, V).
double uncalibrated_angle(double u, double v);

/// An angle difference in (-pi, pi].
double wrapped(double radians);

/// Largest minus smallest of angle - truth, in radians, whatever turns and constant lie between
/// the two. The error must stay within half a turn of its mean direction. 0 without samples.
double peak_to_peak_error(const Channel& angle, const Channel& truth);

/// The same for the angles that a model gives for the samples.
double peak_to_peak_error(const Parameters& parameters, const Channel& u, const Channel& v,
                          const Channel& truth);
double peak_to_peak_error(const SignalModel& model, const Channel& u, const Channel& v,
                          const Channel& truth);

}  // namespace capsoc::identification
