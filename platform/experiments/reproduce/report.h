#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/data_table.h"

namespace capsoc::reproduce {

/// A figure as it is printed, with its number or, of several seeds, the least and the greatest.
struct Figure {
  std::string text;
  std::optional<double> least, greatest;

  /// The numbers are those of the text; none in "never".
  Figure(std::string printed);
  Figure(const char* printed) : Figure(std::string(printed)) {}
  Figure(std::string printed, double value)
      : text(std::move(printed)), least(value), greatest(value) {}
  Figure(std::string printed, double low, double high)
      : text(std::move(printed)), least(low), greatest(high) {}
};

/// A value with `decimals` decimals, as 0.60 or 6.0e-1.
Figure fixed(double value, int decimals);
Figure scientific(double value, int decimals);

/// A value in a sentence: as many digits as tell it from its neighbours' limits.
std::string number_text(double value);

/// What our figure may be, ends included. An absent end is no limit.
struct Bound {
  std::optional<double> least, greatest;

  static Bound at_most(double value) { return {std::nullopt, value}; }
  /// `value` give or take `part` of it.
  static Bound around(double value, double part);

  /// All of our figures lie in it. None does when there is no number ("never").
  bool holds(const Figure& here) const;
  /// One of them does: the paper's can be another seed of the same experiment.
  bool touches(const Figure& here) const;
  /// "1 .. 2", "at most 2".
  std::string text() const;
};

/// Whether a figure agrees with the paper's, and what it may be: there is no agreement without.
struct Agreement {
  bool holds;
  Bound bound;
  std::optional<double> tolerance;  ///< how far apart the two may be, where that is one number
  std::string text;                 ///< "within 0.005", "at most 2"

  explicit operator bool() const { return holds; }
};

/// Ours lies in the bound.
Agreement lies_in(const Figure& here, const Bound& bound);

/// What several seeds of one experiment gave.
class Spread {
 public:
  void add(double value) { values_.push_back(value); }
  double least() const;
  double greatest() const;

  /// Whether a figure printed with `decimals` places can be another seed of the same experiment:
  /// it lies in the spread widened by `widened` times its width at both ends and by half a printed
  /// unit. The tolerance is that margin, beyond the seeds. Six seeds show two thirds of what more
  /// would; 0 where the values are all that there can be.
  Agreement admits(double printed, int decimals, double widened = 0.5) const;

  /// "least .. greatest", one figure when both print alike.
  std::string text(int decimals) const;
  Figure figure(int decimals) const { return {text(decimals), least(), greatest()}; }

 private:
  std::vector<double> values_;
};

/// One comparison. The label's last part names the unit ("ratio, %"), or the figures do ("2 s").
struct Row {
  std::string label;
  Figure paper, here;
  Bound bound;
  std::optional<double> tolerance;
  enum class Verdict { agrees, known, unexpected, holds, none } verdict;
  std::string limits;  ///< in words: what "agrees" or "differs" allows
  std::string why;     ///< of a known difference
};

/// "agrees within ...", "differs (... .. ...): why", "holds ..." or what stands next to a row that
/// should be one of them; nothing where there is nothing to compare.
std::string verdict_text(const Row& row);

/// The row for programs: quantity, unit, paper, paper_value, here, here_least, here_greatest,
/// tolerance, bound_least, bound_greatest, verdict ("agrees", "known", "unexpected", "holds",
/// "" without a bound) and note.
Fields fields(const Row& row);

/// Id and title of every table in the order in which they are printed.
const std::vector<std::pair<std::string, std::string>>& table_names();

/// The printed comparison: a paper's figures next to ours. Text and data are made of the same rows.
class Report {
 public:
  /// `chosen`: only the tables with these ids; empty: all.
  explicit Report(std::ostream& out, std::vector<std::string> chosen = {})
      : out_(out), chosen_(std::move(chosen)) {}

  /// Whether one of them is to be printed at all.
  bool wants(const std::vector<std::string>& ids) const;

  /// What follows belongs to this table of table_names().
  void heading(const std::string& id);
  void sentence(const std::string& text);

  /// A row that must agree; when it does not, it says so and is counted.
  void row(const std::string& label, const Figure& paper, const Figure& here,
           const Agreement& agreement);

  /// A row that is known to differ, with what ours may be and the sentence that says why. Out of
  /// the bound the sentence is not true, and the row is counted.
  void known(const std::string& label, const Figure& paper, const Figure& here, const Bound& bound,
             const std::string& why);

  /// A figure that the paper does not have, with what it may be. Out of the bound it is counted.
  void ours(const std::string& label, const Figure& here, const Bound& bound);

  /// A figure of the paper next to one that is not compared with it.
  void stated(const std::string& label, const Figure& paper, const Figure& here);

  /// A point of a curve that the paper draws without numbers.
  void point(const std::string& label, const Figure& here);

  /// An experiment that could not be made, whatever was chosen.
  void failure(const std::string& what, const std::string& reason);

  int unexpected() const { return unexpected_; }
  const std::vector<DataTable>& tables() const { return tables_; }

 private:
  void line(const std::string& label, const std::string& paper, const std::string& here,
            const std::string& verdict);
  void add(const Row& row);

  std::ostream& out_;
  std::vector<std::string> chosen_;
  bool shown_ = true;  ///< the present table was chosen
  std::vector<DataTable> tables_;
  int unexpected_ = 0;
};

/// No further apart than `tolerance`.
Agreement within(double here, double printed, double tolerance);

/// Within half a unit of the last printed place, or within `relative` of the printed figure.
Agreement agrees(double here, double printed, int decimals, double relative = 0.0);

}  // namespace capsoc::reproduce
