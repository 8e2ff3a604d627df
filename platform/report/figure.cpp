#include "report/figure.h"

#include <algorithm>

namespace capsoc::report {
namespace {

bool is_there(const std::vector<Mark>& marks, const Mark& mark) {
  return std::any_of(marks.begin(), marks.end(), [&](const Mark& other) {
    return other.at == mark.at && other.label == mark.label;
  });
}

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
  std::size_t number = 0;
  for (const ResultFile* result : having) {
    Data data = figure.data(figure, result->json);
    if (having.size() == 1) return data;
    ++number;
    std::size_t variant = 0;
    for (Series& series : data.series) {
      if (having.size() == 2) series.colour = number, series.variant = variant++;
      series.name = series.name + ", " + result->label;
      if (figure.kind == Kind::lines) series.curve = thinned(series.curve, buckets / having.size());
      all.series.push_back(std::move(series));
    }
    for (const Mark& mark : data.marks)
      if (!is_there(all.marks, mark)) all.marks.push_back(mark);
    if (data.labels.size() > all.labels.size()) all.labels = std::move(data.labels);
    if (all.title.empty()) all.title = std::move(data.title);
    if (all.columns.all.empty()) all.columns = std::move(data.columns);
  }
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
