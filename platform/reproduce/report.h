#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace capsoc::reproduce {

/// What several seeds of one experiment gave.
class Spread {
 public:
  void add(double value) { values_.push_back(value); }
  double least() const;
  double greatest() const;

  /// Whether a figure printed with `decimals` places can be another seed of the same experiment:
  /// it lies in the spread widened by half its width at both ends and by half a printed unit.
  bool admits(double printed, int decimals) const;

  /// "least .. greatest", one figure when both print alike.
  std::string text(int decimals) const;

 private:
  std::vector<double> values_;
};

/// The printed comparison: a paper's figures beside ours.
class Report {
 public:
  explicit Report(std::ostream& out) : out_(out) {}

  void heading(const std::string& title);
  void sentence(const std::string& text);

  /// A row that must agree; when it does not, it says so and is counted.
  void row(const std::string& label, const std::string& paper, const std::string& here,
           bool agrees);

  /// A row that is known to differ, with the sentence that says why.
  void known(const std::string& label, const std::string& paper, const std::string& here,
             const std::string& why);

  int unexpected() const { return unexpected_; }

 private:
  void line(const std::string& label, const std::string& paper, const std::string& here,
            const std::string& verdict);

  std::ostream& out_;
  int unexpected_ = 0;
};

/// Within half a unit of the last printed place, or within `relative` of the printed figure.
bool agrees(double here, double printed, int decimals, double relative = 0.0);

}  // namespace capsoc::reproduce
