#include "report/figure.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>

#include "report/number_text.h"

namespace capsoc::report {
namespace {

bool is_there(const std::vector<Mark>& marks, const Mark& mark) {
  return std::any_of(marks.begin(), marks.end(), [&](const Mark& other) {
    return other.at == mark.at && other.label == mark.label;
  });
}

/// Bars of several results: those that are called the same stand next to each other.
class Bars {
 public:
  void place(Data& data) {
    std::vector<std::size_t> places;
    std::map<std::string, int> seen;
    for (const std::string& label : data.labels) {
      const Name name = {label, seen[label]++};
      const auto found = std::find(names_.begin(), names_.end(), name);
      places.push_back(static_cast<std::size_t>(found - names_.begin()));
      if (found == names_.end()) names_.push_back(name);
    }
    for (Series& series : data.series)
      for (double& x : series.curve.x)
        if (is_place(x, places.size()))
          x = static_cast<double>(places[static_cast<std::size_t>(x)]);
  }

  /// Numbers stand in their order.
  void finish(Data& all) const {
    std::vector<std::size_t> order(names_.size());
    std::iota(order.begin(), order.end(), 0);
    const auto number = [&](std::size_t i) {
      return std::strtod(names_[i].first.c_str(), nullptr);
    };
    if (std::all_of(names_.begin(), names_.end(),
                    [](const Name& name) { return is_number(name.first); }))
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return number(a) < number(b); });
    std::vector<double> place(names_.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      all.labels.push_back(names_[order[i]].first);
      place[order[i]] = static_cast<double>(i);
    }
    for (Series& series : all.series)
      for (double& x : series.curve.x)
        if (is_place(x, place.size())) x = place[static_cast<std::size_t>(x)];
  }

 private:
  static bool is_place(double x, std::size_t count) {
    return x >= 0 && x < static_cast<double>(count);
  }

  using Name = std::pair<std::string, int>;  ///< the label, and how often it stood before
  std::vector<Name> names_;
};

}  // namespace

const std::vector<Figure>& figures() {
  static const std::vector<Figure> all = [] {
    std::vector<Figure> list;
    add_run_figures(list);
    add_fit_figures(list);
    add_reproduce_figures(list);
    add_accuracy_figures(list);
    add_bench_figures(list);
    add_regress_figures(list);
    add_campaign_figures(list);
    return list;
  }();
  return all;
}

const Figure* figure_named(const std::string& name) {
  for (const Figure& figure : figures())
    if (figure.name == name) return &figure;
  return nullptr;
}

Data data_of(const Figure& figure, const std::vector<ResultFile>& results) {
  constexpr std::size_t buckets = 1000;
  std::vector<const ResultFile*> having;
  for (const ResultFile& result : results)
    if (command_of(result.json) == figure.command) having.push_back(&result);
  Data all;
  Bars bars;
  for (std::size_t number = 0; number < having.size(); ++number) {
    Data data = figure.data(figure, having[number]->json);
    if (having.size() == 1) return data;
    // Columns are chosen of one result.
    if (!data.columns.all.empty()) return {};
    if (figure.kind == Kind::bars) bars.place(data);
    for (std::size_t i = 0; i < data.series.size(); ++i) {
      Series& series = data.series[i];
      if (having.size() == 2) series.colour = number + 1, series.variant = i;
      series.name = series.name + ", " + having[number]->label;
      if (figure.kind == Kind::lines) series.curve = thinned(series.curve, buckets / having.size());
      all.series.push_back(std::move(series));
    }
    for (const Mark& mark : data.marks)
      if (!is_there(all.marks, mark)) all.marks.push_back(mark);
    if (all.title.empty()) all.title = std::move(data.title);
  }
  bars.finish(all);
  return all;
}

std::size_t colour_of(const Data& data, std::size_t series) {
  const std::size_t colour = data.series[series].colour;
  return (colour > 0 ? colour - 1 : series) % 6;
}

const std::string& title_of(const Figure& figure, const Data& data) {
  return data.title.empty() ? figure.title : data.title;
}

std::string whole_caption(const Figure& figure) {
  std::string text = figure.caption + " From capsoc " + figure.command + ".";
  if (!figure.papers.empty()) text += " Beside it: " + figure.papers + ".";
  return text;
}

}  // namespace capsoc::report
