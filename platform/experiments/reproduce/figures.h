#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/curve.h"
#include "fit/fit.h"
#include "reproduce/report.h"

namespace capsoc::reproduce {

/// Reproduces the SoC paper's figures that have no numbers: learning curves (7, 9 and 12), the gain
/// under a speed disturbance (10), and the spectra of the experiment (19). The latter use the trace
/// that was rebuilt from that figure. Prints nothing if the table was not chosen. `traces`: the
/// folder of the traces.
void figure_7(Report& report);
void figure_9(Report& report);
void figure_10(Report& report);
void figure_12(Report& report);
void figure_19(Report& report, const std::string& traces);

/// The gain of Figure 10 over time (s) for a speed disturbance with this peak, 400 s at 250 Hz.
Curve gain_curve(double scale);

/// Amplitudes of a signal by order of the angle (radians), 0 .. `orders`, by least squares.
std::vector<double> order_amplitudes(const Eigen::ArrayXd& angle, const Eigen::ArrayXd& signal,
                                     int orders);

/// Amplitudes of the orders 2 to 5 of both channels in parts of the first, by least squares at the
/// true angles. `described`: what the trace says of each; a row may be 1e-4 off it.
void spectrum_rows(Report& report, const fit::Record& record,
                   const std::array<double, 4>& described);

/// Loss and parameters of a training on its way; the fit must have been made with a trace. The last
/// points are within 1 % of the answer.
void learning_rows(Report& report, const fit::Fit& fit);

}  // namespace capsoc::reproduce
