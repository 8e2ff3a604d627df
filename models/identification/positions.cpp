#include "identification/positions.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <vector>

#include "identification/circle_plane.h"
#include "identification/distributions.h"
#include "identification/sectors.h"

namespace capsoc::identification {
namespace {

constexpr int fewest_groups = 5, most_groups = 800;
/// Samples a group, on the average, and the part of the circle that the groups may fill. Random
/// angles lie in groups as well: of six samples they fill a half, of three a quarter.
constexpr double many_in_group = 6, fewest_in_group = 3;
constexpr double widest_of_many = 0.4, widest_of_few = 0.15;
/// Samples this many standard deviations of the angle's noise apart are two groups.
constexpr double apart = 3;
/// Angles that differ by less are one, degrees.
constexpr double finest = 0.3;

struct Group {
  double count = 0, sum = 0, square = 0;
};

/// The group of every sector, -1 for empty ones; empty when the samples lie in no groups.
std::vector<int> groups_of(const Channel& u, const Channel& v, const Sectors& sectors,
                           double smallest_gap) {
  std::bitset<Sectors::count> occupied;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const int sector = sectors.of(u[i], v[i]);
    if (sector >= 0) occupied.set(static_cast<std::size_t>(sector));
  }
  if (occupied.none()) return {};
  int first = 0;
  while (!occupied[static_cast<std::size_t>(first)]) ++first;
  std::vector<int> group(Sectors::count, -1);
  int last = first, count = 0, begin = first;
  double filled = 0;
  for (int i = first; i < first + Sectors::count; ++i) {
    const auto place = static_cast<std::size_t>(i % Sectors::count);
    if (!occupied[place]) continue;
    if (Sectors::degrees_at(i) - Sectors::degrees_at(last + 1) > smallest_gap) {
      filled += Sectors::degrees_at(last) - Sectors::degrees_at(begin);
      begin = i;
      ++count;
    }
    group[place] = count;
    last = i;
  }
  filled += Sectors::degrees_at(last) - Sectors::degrees_at(begin);
  // The first and the last are one where no gap is between them.
  if (Sectors::degrees_at(first + Sectors::count) - Sectors::degrees_at(last + 1) <= smallest_gap) {
    for (int& one : group)
      if (one == count) one = 0;
    --count;
  }
  const double each = static_cast<double>(u.size()) / (count + 1);
  const bool narrow = (each >= many_in_group && filled < widest_of_many * 360) ||
                      (each >= fewest_in_group && filled < widest_of_few * 360);
  if (count + 1 < fewest_groups || count + 1 > most_groups || !narrow) return {};
  return group;
}

}  // namespace

Positions positions_of(const Channel& u, const Channel& v, const DistanceFit& fit) {
  const CirclePlane plane(fit.parameters);
  const Sectors sectors(fit.parameters);
  const double angle_noise = fit.noise * plane.largest_slope() * 180 / pi;
  const std::vector<int> group = groups_of(u, v, sectors, std::max(finest, apart * angle_noise));
  Positions positions;
  if (group.empty()) return positions;
  std::vector<Group> groups(
      static_cast<std::size_t>(*std::max_element(group.begin(), group.end())) + 1);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const int sector = sectors.of(u[i], v[i]);
    if (sector < 0) continue;
    const CirclePlane::Polar at = plane.at(u[i], v[i]);
    const double distance = (at.length - 1) / std::sqrt(plane.square_slope(at));
    Group& one = groups[static_cast<std::size_t>(group[static_cast<std::size_t>(sector)])];
    one.count += 1;
    one.sum += distance;
    one.square += distance * distance;
  }
  double between = 0, within = 0;
  for (const Group& one : groups) {
    between += one.sum * one.sum / one.count;
    within += std::max(one.square - one.sum * one.sum / one.count, 0.0);
  }
  const auto count = static_cast<double>(groups.size());
  const double above = count - 5, below = static_cast<double>(u.size()) - count;
  positions.count = static_cast<int>(groups.size());
  if (above < 1 || below < 1) return positions;
  positions.between = between / static_cast<double>(u.size());
  const double pure = within / below;
  // Samples that are equal to the last digit have no scatter.
  positions.lack_of_fit = between / above / std::max(pure, 1e-12 * between / above + 1e-300);
  positions.probability = f_tail(positions.lack_of_fit, above, below);
  return positions;
}

Scores of_means(const Scores& scores, const Positions& positions) {
  Scores means = scores;
  const auto count = static_cast<double>(positions.count);
  const double share = count / scores.count;
  means.count = count;
  means.information *= share;
  means.sum *= share;
  means.square = positions.between * count;
  for (ScoreBlock& block : means.blocks) {
    block.information *= share;
    block.sum *= share;
  }
  return means;
}

}  // namespace capsoc::identification
