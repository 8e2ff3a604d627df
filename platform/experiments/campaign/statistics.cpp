#include "campaign/statistics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/number.h"
#include "identification/distributions.h"

namespace capsoc::campaign {
namespace {

constexpr double confidence = 0.95;
constexpr std::size_t histogram_bins = 20, axis_classes = 12, least_runs_of_class = 10;
constexpr double far_apart = 1000;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  if (below + 1 >= sorted.size()) return sorted.back();
  const double part = at - static_cast<double>(below);
  return part == 0 ? sorted[below] : sorted[below] * (1 - part) + sorted[below + 1] * part;
}

Histogram histogram_of(const std::vector<double>& sorted) {
  Histogram h;
  h.least = sorted.front();
  h.greatest = sorted.back();
  h.logarithmic = h.least > 0 && h.greatest / h.least > far_apart;
  h.bins.assign(h.least == h.greatest ? 1 : histogram_bins, 0);
  for (const double value : sorted) {
    const double share = h.logarithmic ? std::log(value / h.least) / std::log(h.greatest / h.least)
                                       : (value / 2 - h.least / 2) / (h.greatest / 2 - h.least / 2);
    // 0 / 0 of a single value is bin 0.
    const double bin = share > 0 ? share * static_cast<double>(h.bins.size()) : 0;
    ++h.bins[std::min(h.bins.size() - 1, static_cast<std::size_t>(bin))];
  }
  return h;
}

/// 1 .. n; equal values share the mean of their ranks.
std::vector<double> ranks_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    for (std::size_t i = begin; i < end; ++i)
      ranks[order[i]] = (static_cast<double>(begin + end) + 1) / 2;
  }
  return ranks;
}

double squares(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum;
}

std::optional<std::vector<double>> numbers_of(const std::vector<std::string>& texts) {
  std::vector<double> numbers;
  for (const std::string& text : texts) {
    const auto number = finite_number(text);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

/// The class of each run: its value, or the part of the axis in which that is.
std::vector<std::size_t> classes_of(const std::vector<std::string>& axis,
                                    const std::optional<std::vector<double>>& ranks) {
  std::map<std::string, std::size_t> values;
  std::vector<std::size_t> classes;
  classes.reserve(axis.size());
  for (const std::string& value : axis)
    classes.push_back(values.emplace(value, values.size()).first->second);
  const std::size_t most =
      std::clamp<std::size_t>(axis.size() / least_runs_of_class, 2, axis_classes);
  if (values.size() <= most || !ranks) return classes;
  for (std::size_t i = 0; i < classes.size(); ++i)
    classes[i] = static_cast<std::size_t>(((*ranks)[i] - 1) * static_cast<double>(most) /
                                          static_cast<double>(axis.size()));
  return classes;
}

/// What 99 % of the values are below (Wilson and Hilferty 1931).
double chi_squared_99(double degrees) {
  constexpr double normal_99 = 2.3263478740408408;
  const double spread = 2 / (9 * degrees);
  return degrees * std::pow(1 - spread + normal_99 * std::sqrt(spread), 3);
}

}  // namespace

Interval wilson(uint64_t passed, uint64_t count) {
  const double z = identification::normal_quantile(confidence);
  const auto n = static_cast<double>(count);
  const double share = static_cast<double>(passed) / n;
  const double centre = share + z * z / (2 * n);
  const double width = z * std::sqrt(share * (1 - share) / n + z * z / (4 * n * n));
  return {passed == 0 ? 0 : (centre - width) / (1 + z * z / n),
          passed == count ? 1 : (centre + width) / (1 + z * z / n)};
}

std::optional<Summary> summarise(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  Summary summary;
  summary.count = values.size();
  summary.mean = mean_of(values);
  if (values.size() > 1)
    summary.deviation = std::sqrt(squares(values) / static_cast<double>(values.size() - 1));
  for (const double share : quantile_shares) summary.quantiles.push_back(quantile(values, share));
  summary.histogram = histogram_of(values);
  return summary;
}

std::optional<Sensitivity> sensitivity(const std::vector<std::string>& axis,
                                       const std::vector<double>& metric) {
  const auto count = static_cast<double>(metric.size());
  if (metric.size() < 3) return std::nullopt;
  const std::vector<double> ranks = ranks_of(metric);
  const double total = squares(ranks);
  const auto numbers = numbers_of(axis);
  std::optional<std::vector<double>> axis_ranks;
  if (numbers) axis_ranks = ranks_of(*numbers);
  const std::vector<std::size_t> classes = classes_of(axis, axis_ranks);
  std::map<std::size_t, std::vector<double>> members;
  for (std::size_t i = 0; i < classes.size(); ++i) members[classes[i]].push_back(ranks[i]);
  const auto groups = static_cast<double>(members.size());
  if (total == 0 || members.size() < 2 || groups >= count) return std::nullopt;
  double within = 0;
  for (const auto& [number, those] : members) within += squares(those);
  Sensitivity result;
  const auto share_of = [&](double statistic) {
    return std::clamp(1 - (count - 1 - statistic) / (count - groups), 0.0, 1.0);
  };
  result.share = share_of((count - 1) * (1 - within / total));
  result.chance = share_of(chi_squared_99(groups - 1));
  if (!axis_ranks) return result;
  const double own = squares(*axis_ranks), middle = (count + 1) / 2;
  double common = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i)
    common += (ranks[i] - middle) * ((*axis_ranks)[i] - middle);
  result.correlation = common / std::sqrt(own * total);
  return result;
}

}  // namespace capsoc::campaign
