// Curves for reports: points thinned to what a plot can show.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/archive.h"

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

/// Thins curves while they are being made, of however many points: equally many neighbours are one
/// bucket, and where there are too many buckets, each two become one. At most 2 * `buckets` points
/// stay, the first and the last of the curve among them; a curve that has no more stays as it is.
/// Of a longer one each part, a bucket or two, has its least and its greatest point, in the order
/// in which they stood: no spike is lost, whatever is drawn of it. A part that begins with a gap
/// keeps it as a point more.
class Thinner {
 public:
  /// Thins `curves` curves that get their points at the same x. One thinner for all takes half of
  /// the time of one thinner each.
  explicit Thinner(std::size_t buckets, std::size_t curves = 1);

  /// Of one curve.
  void add(double x, double y) {
    if (curves_ == 1) add(x, &y);
  }
  /// A point of each curve.
  void add(double x, const double* y) {
    const std::size_t at = points_++;
    last_x_ = x;
    std::copy_n(y, curves_, last_y_.begin());
    if (room_ == 0) return begin_bucket();
    --room_;
    Bucket* const bucket = buckets_.data() + buckets_.size() - curves_;
    for (std::size_t i = 0; i < curves_; ++i) bucket[i].take({x, y[i], at});
  }

  /// The points until now, of one that was made with the same numbers.
  void visit(Archive& archive);

  /// What stays of the points until now.
  Curve curve(std::size_t number = 0) const;

 private:
  struct Point {
    double x = 0, y = 0;
    std::size_t at = 0;  // its place in the curve

    void visit(Archive& archive);
  };
  struct Bucket {
    Point first, least, greatest;  // the same while there is no number

    /// One that comes later.
    void take(const Point& point) {
      if (least.y <= point.y && point.y <= greatest.y) return;  // by far the most
      if (std::isnan(point.y)) return;
      // So a number also takes the place of a gap.
      if (!(least.y <= point.y)) least = point;
      if (!(greatest.y >= point.y)) greatest = point;
    }

    void visit(Archive& archive);
  };
  /// With the newest point.
  void begin_bucket();
  void halve();

  std::size_t parts_;  // at the end; at most half the number of buckets
  std::size_t curves_;
  std::size_t width_ = 1;  // points of a bucket
  std::size_t room_ = 0;   // free places for points in the last bucket
  std::size_t points_ = 0;
  double last_x_ = 0;
  std::vector<double> last_y_;   // by curve
  std::vector<Bucket> buckets_;  // by time, then by curve
};

/// The same of a curve that is there.
Curve thinned(const Curve& curve, std::size_t buckets);

/// Rounds to `digits` significant digits: enough for a plot, and fewer bytes.
double rounded(double value, int digits);

/// `{name: {"x": [...], "y": [...]}}`, gaps as null.
nlohmann::ordered_json to_json(const Curves& curves);

}  // namespace capsoc
