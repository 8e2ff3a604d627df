// Curves for reports: points thinned to what a plot can show.
#pragma once

#include <cmath>
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

/// Thins a curve while it is being made. The points of equally many neighbours each become their
/// least and their greatest one, in the order in which they stood: no spike is lost, whatever is
/// drawn of it. At most 2 * `buckets` points, the first and the last of the curve among them; a
/// curve that has no more stays as it is. A bucket that begins with a gap keeps it.
class Thinner {
 public:
  /// `points` are going to be added.
  Thinner(std::size_t points, std::size_t buckets);

  void add(double x, double y) {
    if (keeps_all_) return kept_.add(x, y);
    const Point point{x, y, at_};
    if (at_ == next_)
      begin_bucket(point);
    else
      take(point);
    ++at_;
  }

  /// What stays, once all points are there.
  Curve curve() && { return std::move(kept_); }

 private:
  struct Point {
    double x = 0, y = 0;
    std::size_t at = 0;
  };
  void begin_bucket(Point point);
  void end_bucket();
  void take(Point point) {
    if (is_empty_) {
      if (std::isnan(point.y)) return;
      least_ = greatest_ = point;
      is_empty_ = false;
    }
    if (point.y < least_.y) least_ = point;
    if (point.y > greatest_.y) greatest_ = point;
  }

  std::size_t points_;
  bool keeps_all_;
  std::size_t inner_, parts_;      // points but for the ends, and buckets of them
  std::size_t at_ = 0, next_ = 0;  // the point to come, and that with which a bucket begins
  std::size_t part_ = 0;           // the bucket that begins there
  Curve kept_;
  Point least_, greatest_;  // of the bucket; nothing while it is empty
  bool is_empty_ = true;
};

/// The same of a curve that is there.
Curve thinned(const Curve& curve, std::size_t buckets);

/// The number with so many significant digits that is nearest: what a plot needs, and fewer bytes.
double rounded(double value, int digits);

/// `{name: {"x": [...], "y": [...]}}`, gaps as null.
nlohmann::ordered_json to_json(const Curves& curves);

}  // namespace capsoc
