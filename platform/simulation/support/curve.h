// Curves for reports: points thinned to what a plot can show.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace capsoc {

/// Points in the order in which they are drawn, x and y of the same length. A y that is no number
/// is a gap.
struct Curve {
  std::vector<double> x, y;

  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
};

/// Curves by name, in order.
using Curves = std::vector<std::pair<std::string, Curve>>;

/// The points of equally many neighbours each become their least and their greatest one, in the
/// order in which they stood: no spike is lost, whatever is drawn of it. At most 2 * `buckets`
/// points, the first and the last of the curve among them; a curve that has no more stays as it is.
/// A bucket that begins with a gap keeps it.
Curve thinned(const Curve& curve, std::size_t buckets);

/// The number with so many significant digits that is nearest: what a plot needs, and fewer bytes.
double rounded(double value, int digits);

/// `{name: {"x": [...], "y": [...]}}`, gaps as null.
nlohmann::ordered_json to_json(const Curves& curves);

}  // namespace capsoc
