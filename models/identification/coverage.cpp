#include "identification/coverage.h"

#include <algorithm>
#include <cmath>

#include "identification/sectors.h"

namespace capsoc::identification {
namespace {

/// A gap up to this is the spacing of the samples, not a part of the circle that is missing.
constexpr double smallest_gap = 10;

std::size_t degree_of(double degrees) {
  const double folded = degrees - 360 * std::floor(degrees / 360);
  return std::min<std::size_t>(static_cast<std::size_t>(folded), 359);
}

}  // namespace

bool Coverage::has(double theta) const {
  return degrees[degree_of(theta * 180 / pi)];
}

Coverage Coverage::whole() {
  Coverage coverage{1, 0, {}};
  coverage.degrees.set();
  return coverage;
}

Coverage coverage_of(const Channel& u, const Channel& v, const Parameters& parameters) {
  const Sectors sectors(parameters);
  std::bitset<Sectors::count> occupied;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const int sector = sectors.of(u[i], v[i]);
    if (sector >= 0) occupied.set(static_cast<std::size_t>(sector));
  }
  if (occupied.none()) return {};
  int first = 0;
  while (!occupied[static_cast<std::size_t>(first)]) ++first;
  // Samples that are far apart because they are few leave no gap.
  const double spacing = std::max(smallest_gap, 4 * 360.0 / static_cast<double>(occupied.count()));
  Coverage coverage = Coverage::whole();
  int last = first;
  for (int i = first + 1; i <= first + Sectors::count; ++i) {
    if (!occupied[static_cast<std::size_t>(i % Sectors::count)]) continue;
    const double from = Sectors::degrees_at(last), to = Sectors::degrees_at(i);
    coverage.largest_gap = std::max(coverage.largest_gap, to - from);
    if (to - from > spacing) {
      coverage.part -= (to - from) / 360;
      for (double at = std::floor(from) + 1; at + 1 <= to; at += 1)
        coverage.degrees.reset(degree_of(at));
    }
    last = i;
  }
  coverage.part = std::max(coverage.part, 0.0);
  return coverage;
}

}  // namespace capsoc::identification
