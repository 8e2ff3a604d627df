// Closed-form fits of the ellipse that the CSFN is trained on: check and starting point.
#pragma once

#include <array>

#include "base/result.h"
#include "identification/moments.h"
#include "identification/samples.h"

namespace capsoc::identification {

/// All three fit the conic A x^2 + B xy + C y^2 + D x + E y + F = 0 to samples that are shifted to
/// mean 0 and scaled alike in both channels. Errors: those of check_samples(), and a conic that is
/// no ellipse.

/// Heydemann's least squares (Appl. Opt. 20, 1981): F = -1 in the shifted coordinates, whose origin
/// lies within the ellipse. The cheapest; biased by noise.
Result<Parameters> fit_heydemann(const Channel& u, const Channel& v);
Result<Parameters> fit_heydemann(const Moments& record);

/// Taubin's fit (PAMI 13, 1991): algebraic distances divided by the mean squared gradient. The best
/// of the three under noise.
Result<Parameters> fit_taubin(const Channel& u, const Channel& v);
Result<Parameters> fit_taubin(const Moments& record);

/// Direct fit with 4AC - B^2 = 1 (Fitzgibbon) in Halir and Flusser's stable form (1998): always
/// an ellipse, also on short arcs; biased to small ones by noise.
Result<Parameters> fit_direct(const Channel& u, const Channel& v);
Result<Parameters> fit_direct(const Moments& record);

/// The ellipse A u^2 + B uv + C v^2 + D u + E v + F = 0, A first. Error: it is none.
Result<Parameters> parameters_of_conic(const std::array<double, 6>& conic);

}  // namespace capsoc::identification
