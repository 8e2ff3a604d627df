#include "identification/left_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "identification/circle_plane.h"
#include "identification/distributions.h"
#include "identification/ellipse_distance.h"
#include "identification/sectors.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

/// The turn in parts of 3 degrees, each looked at together with the next.
constexpr int parts = 120;
constexpr int sectors_a_part = Sectors::count / parts;
/// Outliers within this part of the smaller half axis keep the angle that they were taken at.
constexpr double near_part = 0.3;
constexpr int fewest = 6;
/// Records of disturbances alone that are refused for their places.
constexpr double place_false_alarms = 1e-5;
/// A hole is this many times the kept samples' spacing, at least, and as many degrees.
constexpr double hole_spacings = 10, least_hole = 3;
/// The part of a hole's missing samples that the outliers must be able to fill.
constexpr double filled_part = 0.5;

struct Places {
  std::array<double, parts> kept{}, outside{};
  double kept_count = 0, near_count = 0;
  std::vector<int> occupied;  ///< kept samples of each sector
};

int part_of(int sector) {
  return std::min(sector / sectors_a_part, parts - 1);
}

Places places_of(const Samples& samples, const RobustFit& robust) {
  const Parameters& p = robust.fit.parameters;
  const Sectors sectors(p);
  const EllipseDistance distance(p);
  const double reach = near_part / CirclePlane(p).largest_slope();
  Places places;
  places.occupied.assign(Sectors::count, 0);
  auto next = robust.outliers.begin();
  for (Eigen::Index i = 0; i < samples.u.size(); ++i) {
    const int sector = sectors.of(samples.u[i], samples.v[i]);
    const bool outside = next != robust.outliers.end() && *next == i;
    if (outside) ++next;
    if (sector < 0) continue;
    const auto part = static_cast<std::size_t>(part_of(sector));
    if (!outside) {
      places.kept[part] += 1;
      places.kept_count += 1;
      ++places.occupied[static_cast<std::size_t>(sector)];
    } else if (std::abs(distance.at(samples.u[i], samples.v[i])) < reach) {
      places.outside[part] += 1;
      places.near_count += 1;
    }
  }
  return places;
}

/// The part of the turn (its first sector) where outliers come together; -1: none.
int gathered(const Places& places) {
  if (places.near_count < fewest) return -1;
  constexpr int half = parts / 2;
  for (int part = 0; part < parts; ++part) {
    const auto here = static_cast<std::size_t>(part),
               after = static_cast<std::size_t>((part + 1) % parts);
    const double outside = places.outside[here] + places.outside[after];
    const double kept = places.kept[here] + places.kept[after];
    // With the outliers' share of that part, were they disturbances of samples at any angle.
    const double share = (kept + outside + 1) / (places.kept_count + places.near_count + half);
    if (outside >= fewest && outside > 3 * share * places.near_count &&
        binomial_tail(outside, places.near_count, std::min(share, 0.999)) <
            place_false_alarms / parts)
      return part * sectors_a_part;
  }
  return -1;
}

/// A hole between the kept samples that the outliers would fill: its size, degrees, and where it
/// begins; 0: none.
struct Hole {
  double size = 0;
  int begin = 0;
};

Hole hole_of(const Places& places, double outliers) {
  int first = 0, occupied = 0;
  for (const int count : places.occupied) occupied += count > 0 ? 1 : 0;
  if (occupied == 0 || outliers < fewest) return {};
  while (places.occupied[static_cast<std::size_t>(first)] == 0) ++first;
  Hole hole;
  int last = first;
  for (int i = first + 1; i <= first + Sectors::count; ++i) {
    if (places.occupied[static_cast<std::size_t>(i % Sectors::count)] == 0) continue;
    const double size = Sectors::degrees_at(i) - Sectors::degrees_at(last + 1);
    if (size > hole.size) hole = {size, (last + 1) % Sectors::count};
    last = i;
  }
  const double rest = 360 - hole.size;
  const double spacing = rest / occupied;
  if (hole.size < std::max(least_hole, hole_spacings * spacing)) return {};
  const double missing = places.kept_count * hole.size / std::max(rest, 1.0);
  return outliers >= filled_part * missing ? hole : Hole{};
}

}  // namespace

Gate check_left_out(const Samples& samples, const RobustFit& robust) {
  Gate gate = {"places", true, 0, 0, ""};
  if (robust.outliers.size() < fewest) return gate;
  const Places places = places_of(samples, robust);
  const auto outliers = static_cast<double>(robust.outliers.size());
  if (const int sector = gathered(places); sector >= 0) {
    gate.passed = false;
    gate.reason = text(
        "%.0f samples lie off the ellipse of the others and are near the same angles, first at "
        "%.0f "
        "degrees: a dead zone, a stuck code or a bad contact; find what "
        "the sensor does there",
        outliers, Sectors::degrees_at(sector));
  } else if (const Hole hole = hole_of(places, outliers); hole.size > 0) {
    gate.passed = false;
    gate.reason = text(
        "without the outliers %.1f degrees of the turn after %.0f degrees have no sample: the "
        "sensor "
        "has a dead zone, or is disturbed there on every turn; find what it does there",
        hole.size, Sectors::degrees_at(hole.begin));
  }
  return gate;
}

}  // namespace capsoc::identification
