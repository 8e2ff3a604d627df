#include "identification/distributions.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>

#include "base/constants.h"

namespace capsoc::identification {
namespace {

/// The regularised incomplete beta function I_x(a, b).
double incomplete_beta(double a, double b, double x) {
  return Eigen::numext::betainc(a, b, std::clamp(x, 0.0, 1.0));
}

}  // namespace

double normal_quantile(double share) {
  double x = 1;
  for (int i = 0; i < 50; ++i) {  // Newton on erf(x/sqrt 2) = share; erf is concave for x > 0
    const double step =
        (std::erfc(x / std::sqrt(2.0)) - (1 - share)) / (std::sqrt(2 / pi) * std::exp(-x * x / 2));
    x = std::max(x + std::min(step, 1.0), x / 10);
    if (std::abs(step) < 1e-14) break;
  }
  return x;
}

double student_quantile(double share, double freedom) {
  return std::sqrt(f_quantile(1 - share, 1, freedom));  // t^2 is F of 1 and `freedom`
}

double f_tail(double value, double above, double below) {
  if (!(value > 0)) return 1;
  return incomplete_beta(below / 2, above / 2, below / (below + above * value));
}

double f_quantile(double tail, double above, double below) {
  double low = 0, high = 1;
  while (f_tail(high, above, below) > tail && high < 1e300) high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = low + (high - low) / 2;
    (f_tail(middle, above, below) > tail ? low : high) = middle;
  }
  return high;
}

double binomial_tail(double least, double count, double part) {
  if (least <= 0) return 1;
  return least > count ? 0 : incomplete_beta(least, count - least + 1, part);
}

}  // namespace capsoc::identification
