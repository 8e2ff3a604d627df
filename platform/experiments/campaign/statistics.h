// What a report says of many numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace capsoc::campaign {

struct Interval {
  double least, greatest;
};

/// Wilson's score interval of a share, 95 %: `passed` of `count` > 0 independent runs.
Interval wilson(uint64_t passed, uint64_t count);

/// Shares of the quantiles that a summary has.
inline constexpr double quantile_shares[] = {0, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1};

struct Histogram {
  bool logarithmic = false;  ///< bins of equal ratio: all values are above 0 and far apart
  double least = 0, greatest = 0;
  std::vector<uint64_t> bins;  ///< the last one includes `greatest`
};

struct Summary {
  uint64_t count = 0;
  double mean = 0, deviation = 0;  ///< standard deviation, of the sample; 0 for one value
  std::vector<double> quantiles;   ///< at quantile_shares, between neighbours in proportion
  Histogram histogram;
};

/// Nothing without values.
std::optional<Summary> summarise(std::vector<double> values);

/// How much a metric depends on an axis alone.
struct Sensitivity {
  /// Share of the variance of the metric's ranks that the axis explains: epsilon squared of Kruskal
  /// and Wallis's test, 0 .. 1. The groups are the axis's values; or equal parts, where there are
  /// more than 12 values or fewer than 10 runs of each. About 0 without a dependence; it also finds
  /// dependences that are not monotonic.
  double share = 0;
  /// A share that chance alone exceeds for one in a hundred axes without any influence: from the
  /// quantile of the chi-squared distribution that Kruskal and Wallis's statistic then has.
  double chance = 0;
  /// Spearman's rank correlation, -1 .. 1; empty for an axis of texts.
  std::optional<double> correlation;
};

/// One value of the axis and one of the metric a run. Nothing with fewer than 3 runs, or where one
/// of the two is always the same.
std::optional<Sensitivity> sensitivity(const std::vector<std::string>& axis,
                                       const std::vector<double>& metric);

}  // namespace capsoc::campaign
