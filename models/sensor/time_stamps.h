// What the time stamps of a recording tell: its rate, and what is wrong with them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace capsoc::sensor {

/// Takes the stamps of a recording in the order of its rows, in memory that does not grow with
/// them. The regular step is the median of the first few thousand; a step of 1.75 times and more is
/// a gap, since samples are missing there.
class TimeStamps {
 public:
  /// How sentences call a place and what is missing in a gap.
  explicit TimeStamps(const char* place = "line", const char* things = "samples")
      : place_(place), things_(things) {}

  /// `seconds` of the next row, which stands in `line`.
  void add(double seconds, unsigned long line);

  struct Verdict {
    std::optional<double> rate_hz;  ///< 1 / the regular step's mean; absent: stamps do not tell it
    std::vector<std::string> remarks;  ///< sentences without the file's name
    std::string error;                 ///< why the rows cannot be taken in their order, or ""
    unsigned long line = 0;            ///< of the error
  };
  /// After the last row.
  Verdict verdict();

 private:
  struct Stamp {
    double seconds;
    unsigned long line;
  };
  struct Place {
    double before = 0, after = 0;
    unsigned long line = 0;
  };

  void learn();
  void take(const Stamp& stamp);
  void remark_on_gaps(Verdict& verdict) const;
  void remark_on_falls(Verdict& verdict) const;

  const char* place_;
  const char* things_;
  std::vector<Stamp> first_;  ///< until the regular step is known
  bool learnt_ = false;
  double step_ = 0;      ///< median of the rising steps
  bool coarse_ = false;  ///< stamps stay for several samples and then rise: part of them is equal

  uint64_t rows_ = 0, regular_ = 0, equal_ = 0, falls_ = 0, small_falls_ = 0, gaps_ = 0;
  double begin_ = 0, last_ = 0, least_ = 0, most_ = 0;
  double regular_sum_ = 0, missing_s_ = 0;
  double shortest_ = 0, longest_regular_ = 0;
  Place first_equal_, first_fall_, longest_gap_;
};

}  // namespace capsoc::sensor
