// The figures of reports. Each is declared once, in a list of its command's; the page, the CSV
// of a plot, a picture of one alone and `capsoc report --list-figures` are all made of that.
#pragma once

#include <string>
#include <vector>

#include "base/curve.h"
#include "report/result_file.h"

namespace capsoc::report {

enum class Kind {
  lines,
  steps,   ///< each value holds until the next
  points,  ///< no function of x: both axes alike
  bars,    ///< x counts Data::labels
  lanes    ///< a line of time for each series, 0 or 1
};

/// One line, cloud or set of bars.
struct Series {
  std::string name;
  Curve curve;
  std::vector<double> low = {}, high = {};  ///< the spread of bars, one a point, or none
  std::size_t colour = 0;                   ///< from 1; 0: by its place
  std::size_t variant = 0;                  ///< tells series of one colour apart: solid, dashed...
};

/// A level to compare with: the sensor's own value, the number that a paper prints, a bound.
struct Mark {
  std::string label;
  double at;
};

/// Where a figure finds a number that a paper prints: the `paper_value` of a row of a table.
struct RowMark {
  std::string table, quantity;
  std::string name;  ///< after "paper" in the mark's label: ", Table 1"
};

/// A number of each run, or a text: then `labels` has them, and the values count those.
struct Column {
  std::string name;
  std::vector<double> values;  ///< NaN: a run that has none
  std::vector<std::string> labels = {};
};

/// What a reader chooses two columns of.
struct Columns {
  std::vector<Column> all;
  std::vector<bool> passed;              ///< of each run
  std::size_t across = 0, up = 0;        ///< drawn at first
  std::size_t first_axis = 0, axes = 0;  ///< those that were set, not measured
};

/// What a result has for a figure; no series: nothing.
struct Data {
  std::vector<Series> series;
  std::vector<Mark> marks = {};
  std::vector<std::string> labels = {};  ///< of bars
  Columns columns = {};                  ///< the series are two of them, if there are some
  std::string title = {};                ///< in place of the figure's; "": that is right
};

/// A declaration.
struct Figure {
  std::string name;     ///< for --plot: lower-case letters, digits, '-'
  std::string command;  ///< whose results have it
  std::string section;  ///< of the report: a heading, or the id of the table that it stands next to
  std::string title;
  std::string caption;  ///< what one sees
  std::string papers;   ///< "SoC paper, Figure 10"; "": in none
  std::string x, y;     ///< axes with units
  Kind kind = Kind::lines;
  bool log = false;  ///< the magnitude on a logarithmic axis, to begin with
  Data (*data)(const Figure& figure, const Json& result) = nullptr;
  std::vector<RowMark> marks = {};
};

/// All of them, by command and in the order of the report.
const std::vector<Figure>& figures();

/// Null if there is none of that name.
const Figure* figure_named(const std::string& name);

/// What the results together have: with more than one each series is named after its result, too,
/// and thinned so that the report stays small. Of two results each has one colour; bars are
/// paired by their labels. Nothing for columns, which are chosen of one result.
Data data_of(const Figure& figure, const std::vector<ResultFile>& results);

/// The number of a series' colour, from 0.
std::size_t colour_of(const Data& data, std::size_t series);

/// The title of this data.
const std::string& title_of(const Figure& figure, const Data& data);

/// The caption with the command and the papers' figures.
std::string whole_caption(const Figure& figure);

// The lists.
void add_run_figures(std::vector<Figure>& list);
void add_fit_figures(std::vector<Figure>& list);
void add_reproduce_figures(std::vector<Figure>& list);
void add_accuracy_figures(std::vector<Figure>& list);
void add_bench_figures(std::vector<Figure>& list);
void add_regress_figures(std::vector<Figure>& list);
void add_campaign_figures(std::vector<Figure>& list);

}  // namespace capsoc::report
