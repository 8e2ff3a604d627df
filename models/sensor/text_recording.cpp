#include "sensor/text_recording.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/printable.h"
#include "sensor/text.h"
#include "sensor/text_dialect.h"

namespace capsoc::sensor {
namespace {

/// Reads a file's rows one by one; what they mean is chosen in begin().
class RowReader {
 public:
  RowReader(TextLines lines, std::string file, bool single)
      : lines_(std::move(lines)), file_(std::move(file)), single_(single) {}

  /// Finds the dialect and the columns.
  std::optional<Error> begin(const std::string& wanted) {
    const std::string_view head = lines_.head();
    if (head.find('\0') != std::string_view::npos)
      return Error{file_ +
                   ": has bytes of no text; name recordings by their kind (.csv, .wav, "
                   ".mat, .sds)"};
    dialect_ = find_dialect(head, single_);
    if (dialect_.width == 0) return empty();
    const auto choice = choose(wanted);
    if (!choice) {
      const unsigned long line =
          dialect_.header_line != 0 ? dialect_.header_line : dialect_.first_row;
      return error_at(file_, line, choice.error());
    }
    choice_ = choice.value();
    const std::size_t heading = dialect_.names.size();
    const bool rows_are_shorter = heading > dialect_.width && dialect_.rows.size() > 2;
    width_ = heading == 0 || rows_are_shorter ? dialect_.width : heading;
    for (const std::size_t place : choice_.place)
      if (place != no_column && place >= width_)
        return error_at(file_, dialect_.first_row,
                        fmt::format("the rows have {} columns and the header {}; complete them",
                                    width_, heading));
    return std::nullopt;
  }

  /// The next row. False at the end, or with an error().
  bool next(RawRow& row) {
    std::string_view line;
    while (lines_.next(line)) {
      if (lines_.number() < dialect_.first_row || is_comment(line)) continue;
      error_ = read(line, row);
      return !error_;
    }
    error_ = lines_.error();
    return false;
  }

  const std::optional<Error>& error() const { return error_; }
  unsigned long line() const { return lines_.number(); }
  const ColumnChoice& choice() const { return choice_; }

 private:
  Error empty() {
    std::string_view line;
    while (lines_.next(line)) continue;
    if (lines_.error()) return *lines_.error();
    return error_at(file_, lines_.number() != 0 ? lines_.number() : 1,
                    "the file is empty; it needs a header row with u and v");
  }

  Result<ColumnChoice> choose(const std::string& wanted) const {
    if (single_) {
      if (!dialect_.names.empty()) return choose_single(dialect_.names, wanted);
      return choose_single_nameless(wanted);
    }
    if (dialect_.names.empty()) return choose_nameless(dialect_.width, dialect_.rows, wanted);
    auto choice = choose_columns(dialect_.names, wanted);
    if (choice || !wanted.empty() || dialect_.names.size() > 1) return choice;
    return Error{
        fmt::format("there is one column, '{}'; name the two files of the sine and the "
                    "cosine, as in 'u.csv,v.csv', or separate columns by , ; tabs or blanks",
                    printable(dialect_.names.front().text))};
  }

  /// Columns of numbers alone: the last one is the signal, and the one before it the time.
  Result<ColumnChoice> choose_single_nameless(const std::string& wanted) const {
    std::vector<ColumnName> names;
    for (std::size_t i = 1; i <= dialect_.width; ++i)
      names.push_back({std::to_string(i), std::to_string(i), ""});
    if (!wanted.empty()) return choose_single(names, wanted);
    std::vector<std::size_t> numeric;
    for (std::size_t i = 0; i < dialect_.width; ++i)
      if (!dialect_.rows.empty() && !std::isnan(dialect_.rows.back()[i])) numeric.push_back(i);
    if (numeric.empty() || numeric.size() > 2) return choose_single(names, wanted);
    ColumnChoice choice;
    choice.place[role_u] = numeric.back();
    if (numeric.size() == 2) choice.place[role_time] = numeric.front();
    return choice;
  }

  std::string name_of(Role role) const {
    const std::size_t place = choice_.place[role];
    return place < dialect_.names.size() ? dialect_.names[place].text : std::to_string(place + 1);
  }

  Error error_here(const std::string& message) const {
    return error_at(file_, lines_.number(), message);
  }

  std::optional<Error> read(std::string_view line, RawRow& row) {
    split_cells(line, dialect_.separator, cells_);
    while (cells_.size() > width_ && cells_.back().empty()) cells_.pop_back();
    if (cells_.size() != width_)
      return error_here(fmt::format("the row has {} columns and the {} {}; complete or remove it",
                                    cells_.size(),
                                    dialect_.names.empty() ? "first rows have" : "header", width_));
    if (auto wrong = number(role_u, row.u)) return wrong;
    if (!single_)
      if (auto wrong = number(role_v, row.v)) return wrong;
    if (choice_.has(role_angle))
      if (auto wrong = number(role_angle, row.angle)) return wrong;
    if (choice_.has(role_time)) return number(role_time, row.time);
    return std::nullopt;
  }

  std::optional<Error> number(Role role, double& value) const {
    const std::string_view cell = cells_[choice_.place[role]];
    if (!to_number(cell, dialect_.decimal_comma, value))
      return error_here(
          fmt::format("'{}' in column '{}' is not a number; correct or remove the row",
                      printable(cell), printable(name_of(role))));
    if (!std::isfinite(value))
      return error_here(fmt::format("'{}' in column '{}' is not finite; remove the row",
                                    printable(cell), printable(name_of(role))));
    return std::nullopt;
  }

  TextLines lines_;
  std::string file_;
  bool single_;
  TextDialect dialect_;
  ColumnChoice choice_;
  std::size_t width_ = 0;
  std::vector<std::string_view> cells_;
  std::optional<Error> error_;
};

Error no_rows(const std::string& file, unsigned long line) {
  return error_at(file, line, "there is no row after the header; a recording needs samples");
}

}  // namespace

Result<RecordedSource> read_text_recording(TextLines lines, const std::string& file,
                                           const RecordingOptions& options) {
  RowReader rows(std::move(lines), file, false);
  if (auto error = rows.begin(options.columns)) return *error;
  RecordingBuilder builder(file, options, rows.choice());
  RawRow row;
  while (rows.next(row)) builder.add(row, rows.line());
  if (rows.error()) return *rows.error();
  if (builder.rows() == 0) return no_rows(file, rows.line());
  return builder.finish();
}

Result<RecordedSource> read_text_pair(TextLines u, const std::string& u_file, TextLines v,
                                      const std::string& v_file, const std::string& file,
                                      const RecordingOptions& options) {
  RowReader one(std::move(u), u_file, true), other(std::move(v), v_file, true);
  if (auto error = one.begin(options.columns)) return *error;
  if (auto error = other.begin(options.columns)) return *error;
  ColumnChoice choice = one.choice();
  choice.place[role_v] = other.choice().place[role_u];
  RecordingBuilder builder(file, options, choice);
  for (RawRow first, second;;) {
    const bool more = one.next(first), others = other.next(second);
    for (const RowReader* rows : {&one, &other})
      if (rows->error()) return *rows->error();
    if (more != others) {
      const bool first_is_shorter = others;
      return error_at(
          first_is_shorter ? u_file : v_file, first_is_shorter ? one.line() : other.line(),
          fmt::format("the file ends after {} samples, and {} continues; give two files "
                      "of one recording, or cut the longer one",
                      builder.rows(), first_is_shorter ? v_file : u_file));
    }
    if (!more) break;
    first.v = second.u;
    builder.add(first, one.line());
  }
  if (builder.rows() == 0) return no_rows(u_file, one.line());
  return builder.finish();
}

Result<RecordedSource> read_recording(std::string_view text, const std::string& file,
                                      const RecordingOptions& options) {
  return read_text_recording(TextLines(text), file, options);
}

}  // namespace capsoc::sensor
