// One axis of a plot: values to places, and the ticks. page.js has the same rule for its zoom.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace capsoc::report {

/// Takes all values, is closed, then gives places. Whatever the values, the places are finite.
class Scale {
 public:
  /// A logarithmic scale shows the decimal logarithm of the magnitude.
  explicit Scale(bool log = false) : log_(log) {}

  /// Whether the value can be plotted: finite, and no zero on a logarithmic scale.
  bool holds(double value) const;
  void take(double value);
  /// Leaves a margin, a part of the range, at both ends. Nothing below 0 if `from_zero` and no
  /// value is.
  void close(double margin, bool from_zero = false);

  /// From 0, the least value, to 1.
  double part(double value) const;

  struct Tick {
    double part;
    std::string label;
  };
  /// Round numbers, or decades.
  std::vector<Tick> ticks() const;

 private:
  double shown(double value) const;
  double part_of_shown(double value) const;
  std::vector<double> round_numbers(double least, double greatest) const;

  bool log_;
  double least_ = std::numeric_limits<double>::infinity(), greatest_ = -least_;
};

/// Six digits; an exponent below 1e-4 and from 1e6 on.
std::string tick_label(double value);

}  // namespace capsoc::report
