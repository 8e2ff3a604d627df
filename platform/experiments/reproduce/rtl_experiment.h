#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/curve.h"
#include "reproduce/coprocessor_run.h"

namespace capsoc::reproduce {

/// The SoC paper's section 4.2 on the coprocessor model in its paper arithmetic.
struct RtlOutcome {
  std::array<uint32_t, 6> words{};  ///< a1, a2, b1, b2, beta, phi at 400 s, machine values
  double uncalibrated = 0.0;        ///< atan2(U, V) against omega k, as the paper counts, degrees
  double online_end = 0.0;          ///< largest angle error within the last 20 s, degrees
  double frozen = 0.0;              ///< with the parameters of 400 s over the whole record, degrees
};

/// Eq (21) in 32 bits, 0.05 Hz, 250 Hz, 400 s, with the settings of CoprocessorRun, or others.
RtlOutcome run_rtl(const coprocessor::Options& options = CoprocessorRun::papers_options());

/// The words a1, a2, b1, b2, beta, phi at these times after the start, in order.
std::vector<std::array<uint32_t, 6>> rtl_learning_curve(const std::vector<double>& times_s);

/// Table 11: the time after which a1, a2, b1, b2 and beta are within 1 % for the first time. phi
/// never is (Table 8).
std::optional<double> rtl_convergence_s();

/// The sine weight's a1 at 400 s with the steps as the paper prints them, not 2^-7 times as large.
double a1_with_printed_steps();

/// Figure 14: largest error of the PI arctangent in radians for sine and cosine of a magnitude at
/// 3,600 angles, without those within 1 degree of half a turn, where the loop hardly starts.
/// `curve` takes the errors over the angle in degrees.
double arctangent_error(double magnitude, Curve* curve = nullptr);

/// Figure 13: the error of the coprocessor's angle in degrees over time (s), with the parameters of
/// 400 s over the whole record.
Curve rtl_angle_error();

}  // namespace capsoc::reproduce
