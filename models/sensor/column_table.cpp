#include "sensor/column_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/printable.h"
#include "sensor/recording_builder.h"

namespace capsoc::sensor {
namespace {

Result<ColumnChoice> choose(const ColumnTable& table, const RecordingOptions& options) {
  if (table.channels && table.columns.size() != 2 && options.columns.empty())
    return Error{fmt::format("there {} {} of sound; choose two with --columns 1,2",
                             table.columns.size() == 1 ? "is" : "are",
                             table.columns.size() == 1
                                 ? std::string("one channel")
                                 : fmt::format("{} channels", table.columns.size()))};
  if (table.named) return choose_columns(table.names, options.columns);
  constexpr std::size_t probed = 10'000;
  std::vector<std::vector<double>> rows;
  std::size_t count = probed;
  for (const auto& column : table.columns) count = std::min(count, column.size());
  for (std::size_t k = 0; k < count; ++k) {
    rows.emplace_back();
    for (const auto& column : table.columns) rows.back().push_back(column[k]);
  }
  return choose_nameless(table.columns.size(), rows, options.columns);
}

}  // namespace

std::vector<ColumnName> numbered_names(std::size_t count) {
  std::vector<ColumnName> names;
  for (std::size_t i = 1; i <= count; ++i)
    names.push_back({std::to_string(i), std::to_string(i), ""});
  return names;
}

Result<RecordedSource> read_table(const ColumnTable& table, const std::string& file,
                                  const RecordingOptions& options) {
  const auto chosen = choose(table, options);
  if (!chosen) return Error{file + ": " + chosen.error()};
  const ColumnChoice& choice = chosen.value();
  const std::size_t count = table.columns[choice.place[role_u]].size();
  for (const std::size_t place : choice.place) {
    if (place == no_column) continue;
    const std::string name = printable(table.names[place].text);
    const std::vector<double>& column = table.columns[place];
    if (column.size() != count)
      return Error{fmt::format("{}: '{}' has {} values and '{}' has {}; they must be as long", file,
                               printable(table.names[choice.place[role_u]].text), count, name,
                               column.size())};
    const auto wrong = std::find_if(column.begin(), column.end(),
                                    [](double value) { return !std::isfinite(value); });
    if (wrong != column.end())
      return Error{fmt::format("{}: value {} of '{}' is not finite; remove that sample", file,
                               wrong - column.begin() + 1, name)};
  }
  if (count == 0) return Error{file + ": there is no sample; a recording needs some"};
  RecordingBuilder builder(file, options, choice);
  for (std::size_t k = 0; k < count; ++k) {
    const auto value = [&](Role role) {
      return choice.has(role) ? table.columns[choice.place[role]][k] : 0;
    };
    builder.add({value(role_u), value(role_v), value(role_angle), value(role_time)},
                static_cast<unsigned long>(k + 1));
  }
  if (table.rate_hz) builder.set_rate(*table.rate_hz);
  for (const std::string& sentence : table.remarks) builder.remark(sentence);
  return builder.finish();
}

}  // namespace capsoc::sensor
