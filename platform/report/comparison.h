// Two results of one command side by side: whether their answers agree, then all that differs. The
// terminal and the page say it in the same words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/result_file.h"

namespace capsoc::report {

/// A value of both results, with the digits that tell them apart.
struct Compared {
  std::string name, unit;
  std::string a, b;              ///< "-": that result does not have it
  std::string exact_a, exact_b;  ///< all digits; "": a and b are exact
  std::string absolute;          ///< b - a; "" unless both are numbers
  std::string relative;          ///< "+3.2 %", or "x 1046" from a tenth or ten times on; else ""
  std::size_t values = 1;        ///< more: a part of a result that the other does not have at all
};

/// Values of one kind.
struct ComparedPart {
  std::string title;                ///< "settings"
  std::vector<Compared> different;  ///< in the order of the results
  std::vector<Compared> same;

  std::size_t different_count() const;  ///< values
  std::size_t count() const { return different_count() + same.size(); }
};

/// A figure of both headlines; "" where one has none.
struct ComparedFigure {
  std::string label, a, b, exact_a, exact_b;
};

struct Comparison {
  std::string label_a, label_b;      ///< the files' names
  const char* style;                 ///< of the sentence: "bad" if the answers differ, else A's
  std::string sentence;              ///< whether the answers agree, and how much differs
  std::string verdict_a, verdict_b;  ///< "pass, exit 0"
  std::vector<ComparedFigure> figures;
  ComparedPart answers, settings, values;
  std::vector<std::string> different_plots, same_plots;  ///< names of figures

  bool is_same() const;  ///< nothing differs
};

/// Nothing unless there are two results, both of one command.
std::optional<Comparison> compared(const std::vector<ResultFile>& results);

/// Why these results are not compared, in one sentence; "" if they are.
std::string reason_not_compared(const std::vector<ResultFile>& results);

/// "57 settings, 59 values and 6 plots": what is the same in both.
std::string count_of_same(const Comparison& comparison);

/// For a terminal: the sentence, then a table of what differs.
std::string text_of(const Comparison& comparison);

}  // namespace capsoc::report
