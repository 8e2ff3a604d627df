// The samples of a run as its pages draw them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "service/verb.h"

namespace capsoc::view {

/// Columns of samples.read, of which points are kept that are spread evenly over the run.
class Curves {
 public:
  /// Beyond these every second point goes, and the next ones are as far apart.
  static constexpr std::size_t most_points = 1500;
  /// Of one frame.
  static constexpr uint64_t most_new = 240;

  static const std::vector<std::string>& columns();

  /// Adds what samples.read answered. Points at or after its first one were of another future.
  void add(const service::Answer& answer);
  /// What was added last, as JSON: {"name": [numbers]}; null: not known.
  std::string newest() const { return text_of(newest_); }
  std::string all() const { return text_of(all_); }

 private:
  using Points = std::vector<std::vector<double>>;  // a vector a column

  static std::string text_of(const Points& points);
  void thin();

  Points newest_ = Points(columns().size()), all_ = Points(columns().size());
};

}  // namespace capsoc::view
