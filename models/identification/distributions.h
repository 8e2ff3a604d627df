// Quantiles of the distributions of the intervals and the tests.
#pragma once

namespace capsoc::identification {

/// Number of standard deviations that hold the given share of a normal distribution, share in
/// (0, 1): 0.95 gives 1.96.
double normal_quantile(double share);

/// The same for Student's distribution with `freedom` degrees of freedom (positive): 0.95 and 15
/// give 2.131.
double student_quantile(double share, double freedom);

/// Probability that F of `above` and `below` degrees of freedom exceeds the value.
double f_tail(double value, double above, double below);

/// The value that F exceeds with the probability `tail`, in (0, 1).
double f_quantile(double tail, double above, double below);

/// Probability of at least `least` successes in `count` independent trials, each with the
/// probability `part` in (0, 1).
double binomial_tail(double least, double count, double part);

}  // namespace capsoc::identification
