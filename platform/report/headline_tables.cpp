// The answers of `capsoc reproduce`, `accuracy` and `bench`: what the rows of their tables say.
#include <fmt/format.h>

#include <algorithm>

#include "report/headline.h"
#include "report/number_text.h"

namespace capsoc::report {
namespace {

struct TableRow {
  std::string table;  ///< its title
  const Json* row;
};

std::vector<TableRow> rows_in(const Json& result) {
  std::vector<TableRow> all;
  for (const Json* table : elements_at(result, {"tables"}))
    for (const Json* row : elements_at(*table, {"rows"}))
      all.push_back({text_at(*table, {"title"}), row});
  return all;
}

std::size_t count_of(const std::vector<TableRow>& rows, const std::string& verdict) {
  return static_cast<std::size_t>(std::count_if(
      rows.begin(), rows.end(),
      [&](const TableRow& each) { return text_at(*each.row, {"verdict"}) == verdict; }));
}

Headline::Figure row_count(const std::string& label, std::size_t count, std::size_t all) {
  return {label, fmt::format("{}", count), fmt::format("{} of {} rows", count, all)};
}

/// Null if no row has the verdict.
const TableRow* first_with(const std::vector<TableRow>& rows, const std::string& verdict) {
  for (const TableRow& each : rows)
    if (text_at(*each.row, {"verdict"}) == verdict) return &each;
  return nullptr;
}

std::string reproduced_name(const TableRow& row) {
  return fmt::format("{} ({}), here {}", text_at(*row.row, {"quantity"}), row.table,
                     text_at(*row.row, {"here"}));
}

/// The row with a bound that comes nearest to it, as a share of the bound.
void add_nearest_bound(Headline& headline, const std::vector<TableRow>& rows) {
  double greatest = -1;
  std::string name;
  for (const TableRow& each : rows) {
    const auto error = number_at(*each.row, {"precise"}), bound = number_at(*each.row, {"bound"});
    if (!error || !bound || *bound <= 0 || *error / *bound <= greatest) continue;
    greatest = *error / *bound;
    name = text_at(*each.row, {"quantity"}) + ": ";
  }
  if (greatest >= 0)
    headline.figures.push_back({"nearest to its bound",
                                fmt::format("{:.3g} % of it", 100 * greatest),
                                fmt::format("{}{} %", name, 100 * greatest)});
}

/// Where no row has a bound.
void add_largest_errors(Headline& headline, const std::vector<TableRow>& rows) {
  for (const auto& [field, label] : {std::pair{"precise", "largest error, precise"},
                                     std::pair{"paper", "largest error, paper's arithmetic"}}) {
    double largest = -1;
    for (const TableRow& each : rows)
      largest = std::max(largest, number_at(*each.row, {field}).value_or(-1));
    if (largest >= 0)
      headline.figures.push_back(
          {label, three_digits(largest) + " deg", fmt::format("{} deg", largest)});
  }
}

/// How far the slowest run of a program is below its best, at most.
void add_spread(Headline& headline, const std::vector<TableRow>& rows) {
  double greatest = -1;
  for (const TableRow& each : rows) {
    const auto best = number_at(*each.row, {"translator_mips"});
    const auto least = number_at(*each.row, {"translator_mips_least"});
    if (best && least && *best > 0) greatest = std::max(greatest, 1 - *least / *best);
  }
  if (greatest >= 0)
    headline.figures.push_back({"slowest run below the best, at most",
                                fmt::format("{:.2g} %", 100 * greatest),
                                fmt::format("{} %", 100 * greatest)});
}

void add_speed(Headline& headline, const Json& mean, const char* label, const char* field,
               const char* unit) {
  const auto value = number_at(mean, {field});
  if (value && *value > 0)
    headline.figures.push_back(
        {label, three_digits(*value) + unit, shown_at(mean, {field}) + unit});
}

/// What went wrong with a program, or "".
std::string bench_failure(const std::vector<TableRow>& rows) {
  if (const TableRow* row = first_with(rows, "failed"))
    return text_at(*row->row, {"program"}) + " failed";
  if (const TableRow* row = first_with(rows, "differs"))
    return text_at(*row->row, {"program"}) + " prints another result than QEMU";
  if (const TableRow* row = first_with(rows, "too slow"))
    return fmt::format("Too slow: {:.2f} of QEMU with -icount",
                       number_at(*row->row, {"icount_ratio"}).value_or(0));
  return "";
}

}  // namespace

Headline headline_of_reproduce(const Json& result) {
  const auto rows = rows_in(result);
  if (rows.empty()) return {};
  const std::size_t unexpected = count_of(rows, "unexpected"), agree = count_of(rows, "agrees");
  const std::size_t hold = count_of(rows, "holds"), known = count_of(rows, "known");
  Headline headline;
  headline.style = unexpected == 0 ? "good" : "bad";
  headline.verdict = fmt::format("{} rows differ that should agree", unexpected);
  headline.sentence =
      fmt::format("{}: {} agree with the papers, {} hold, {} differ for a reason that is known",
                  headline.verdict, agree, hold, known);
  if (const TableRow* first = first_with(rows, "unexpected"))
    headline.sentence += ". The first that should agree: " + reproduced_name(*first);
  headline.figures = {row_count("rows that agree with the papers", agree, rows.size()),
                      row_count("rows that hold", hold, rows.size()),
                      row_count("rows that differ and should agree", unexpected, rows.size())};
  return headline;
}

Headline headline_of_accuracy(const Json& result) {
  const auto rows = rows_in(result);
  if (rows.empty()) return {};
  const std::size_t hold = count_of(rows, "holds");
  const std::size_t missed = count_of(rows, "misses") + count_of(rows, "clips");
  Headline headline;
  headline.style = missed > 0 ? "bad" : hold > 0 ? "good" : "odd";
  headline.verdict = fmt::format("rows that miss their bound: {}", missed);
  headline.sentence = fmt::format("Rows that miss their bound: {}; {} of {} rows have one", missed,
                                  hold + missed, rows.size());
  if (hold + missed == 0) {
    add_largest_errors(headline, rows);
    return headline;
  }
  if (const TableRow* first = first_with(rows, "misses"))
    headline.sentence +=
        fmt::format(". The first: {} ({}), {:.3g} deg", text_at(*first->row, {"quantity"}),
                    first->table, number_at(*first->row, {"precise"}).value_or(0));
  headline.figures = {row_count("rows within their bound", hold, rows.size()),
                      row_count("rows that miss it", missed, rows.size())};
  add_nearest_bound(headline, rows);
  return headline;
}

Headline headline_of_bench(const Json& result) {
  const auto rows = rows_in(result);
  if (rows.empty()) return {};
  const Json& mean = *rows.back().row;  // the geometric mean stands last
  const std::string failure = bench_failure(rows);
  const bool alone = count_of(rows, "no QEMU") > 0;
  Headline headline;
  headline.style = !failure.empty() ? "bad" : alone ? "odd" : "good";
  headline.verdict = !failure.empty() ? "not as wanted" : alone ? "no QEMU" : "good";
  const auto mips = number_at(mean, {"translator_mips"});
  const auto ratio = number_at(mean, {"translator_ratio"});
  if (!failure.empty())
    headline.sentence = failure;
  else if (mips)
    headline.sentence = fmt::format(
        "The translator executes {} million instructions a second{}", three_digits(*mips),
        alone || !ratio ? ". QEMU did not run"
                        : fmt::format(", {:.2f} times QEMU's speed, with the same output", *ratio));
  add_speed(headline, mean, "translator, geometric mean", "translator_mips", " MIPS");
  add_speed(headline, mean, "translator / QEMU", "translator_ratio", "");
  add_spread(headline, rows);
  return headline;
}

}  // namespace capsoc::report
