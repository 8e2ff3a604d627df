// The figures of `capsoc accuracy` and `capsoc bench`: bars of the rows that they print.
#include <fmt/format.h>

#include "report/accuracy_table_names.h"
#include "report/figure.h"

namespace capsoc::report {
namespace {

std::vector<const Json*> rows_of(const Json& result, const std::string& id) {
  for (const Json* table : elements_at(result, {"tables"}))
    if (text_at(*table, {"id"}) == id) return elements_at(*table, {"rows"});
  return {};
}

/// A bar for each row that has the number.
Series bars_of(const std::vector<const Json*>& rows, const char* name, const char* field) {
  Series series{name, {}};
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (const auto value = number_at(*rows[i], {field}))
      series.curve.add(static_cast<double>(i), *value);
  return series;
}

void keep(Data& data, Series series) {
  if (!series.curve.x.empty()) data.series.push_back(std::move(series));
}

Data accuracy_table(const Figure& figure, const Json& result) {
  const auto rows = rows_of(result, figure.section);
  Data data;
  keep(data, bars_of(rows, "precise", "precise"));
  keep(data, bars_of(rows, "paper's arithmetic", "paper"));
  if (data.series.empty()) return data;
  keep(data, bars_of(rows, "bound of precise", "bound"));
  for (const Json* row : rows) data.labels.push_back(text_at(*row, {"quantity"}));
  return data;
}

/// The best of several runs, and the spread down to the worst.
Data speed(const Figure&, const Json& result) {
  const auto rows = rows_of(result, "cpu");
  Data data;
  const auto add = [&](const char* name, const std::string& field) {
    Series series = bars_of(rows, name, field.c_str());
    for (const double at : series.curve.x) {
      const Json& row = *rows[static_cast<std::size_t>(at)];
      const double best = number_at(row, {field.c_str()}).value_or(0);
      series.low.push_back(number_at(row, {(field + "_least").c_str()}).value_or(best));
      series.high.push_back(best);
    }
    keep(data, std::move(series));
  };
  add("blocks", "mips");
  add("translator", "translator_mips");
  add("QEMU", "qemu_mips");
  add("QEMU -icount", "icount_mips");
  if (!data.series.empty())
    for (const Json* row : rows) data.labels.push_back(text_at(*row, {"program"}));
  return data;
}

Data ratios(const Figure&, const Json& result) {
  const auto rows = rows_of(result, "cpu");
  Data data;
  keep(data, bars_of(rows, "translator / QEMU", "translator_ratio"));
  keep(data, bars_of(rows, "translator / QEMU -icount", "translator_icount_ratio"));
  keep(data, bars_of(rows, "blocks / QEMU -icount", "icount_ratio"));
  if (data.series.empty()) return data;
  for (const Json* row : rows) data.labels.push_back(text_at(*row, {"program"}));
  data.marks.push_back({"as fast as QEMU", 1});
  return data;
}

}  // namespace

void add_accuracy_figures(std::vector<Figure>& list) {
  for (const auto& [id, title] : accuracy::table_names)
    list.push_back({fmt::format("accuracy-{}", id), "accuracy", id, title,
                    "Largest angle error of each row in both arithmetics, and its bound.", "",
                    "row", "angle error, deg", Kind::bars, true, accuracy_table});
}

void add_bench_figures(std::vector<Figure>& list) {
  list.push_back({"bench-mips", "bench", "cpu", "Speed by program",
                  "Millions of instructions a second of processor time: the best run, and a line "
                  "down to the slowest.",
                  "", "program", "MIPS", Kind::bars, false, speed});
  list.push_back({"bench-ratio", "bench", "cpu", "Ratio to QEMU", "Our speed divided by QEMU's.",
                  "", "program", "ratio", Kind::bars, true, ratios});
}

}  // namespace capsoc::report
