#include "sensor/recorded_source.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "sensor/motion.h"
#include "sensor/text.h"
#include "support/nearest.h"
#include "support/printable.h"

namespace capsoc::sensor {
namespace {

enum Column { column_u, column_v, column_angle, column_time, column_count };
const std::array<std::string, column_count> column_names = {"u", "v", "angle_deg", "t"};

constexpr size_t absent = static_cast<size_t>(-1);

struct Header {
  std::array<size_t, column_count> place;  ///< position of each known column, or absent
  size_t width = 0;                        ///< number of columns
};

std::vector<std::string_view> split_cells(std::string_view line) {
  std::vector<std::string_view> cells;
  for (size_t start = 0;;) {
    const size_t comma = line.find(',', start);
    cells.push_back(trimmed(line.substr(start, comma - start)));
    if (comma == std::string_view::npos) return cells;
    start = comma + 1;
  }
}

/// Hands out the lines that count, with their numbers.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (rest_.substr(0, 3) == byte_order_mark) rest_.remove_prefix(3);
  }

  bool next(std::string_view& line) {
    while (!rest_.empty()) {
      const size_t end = rest_.find('\n');
      line = rest_.substr(0, end);
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number_;
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      line = trimmed(line);
      if (!line.empty() && line.front() != '#') return true;
    }
    return false;
  }

  unsigned long number() const { return number_; }

 private:
  std::string_view rest_;
  unsigned long number_ = 0;
};

class Reader {
 public:
  Reader(std::string_view text, const std::string& file) : lines_(text), file_(file) {}

  Result<RecordedSource> read() {
    std::string_view line;
    if (!lines_.next(line)) return error("the file is empty; it needs a header row with u and v");
    const Result<Header> header = read_header(line);
    if (!header) return Error{header.error()};
    std::vector<RecordedSource::Row> rows;
    while (lines_.next(line)) {
      if (const auto wrong = read_row(header.value(), line, rows)) return *wrong;
    }
    if (rows.empty()) return error("there is no row after the header; a recording needs samples");
    Description known = description(rows.size());
    const bool has_truth = header.value().place[column_angle] != absent;
    return RecordedSource(std::move(known), std::move(rows), has_truth);
  }

 private:
  // A file without any line still needs a line number in its sentence.
  Error error(const std::string& message) const {
    return error_at(file_, lines_.number() ? lines_.number() : 1, message);
  }

  Result<Header> read_header(std::string_view line) const {
    Header header;
    header.place.fill(absent);
    const std::vector<std::string_view> names = split_cells(line);
    header.width = names.size();
    for (size_t i = 0; i < names.size(); ++i) {
      for (size_t column = 0; column < column_count; ++column) {
        if (names[i] != column_names[column]) continue;
        if (header.place[column] != absent) {
          return error(fmt::format("column '{}' appears twice; keep one", column_names[column]));
        }
        header.place[column] = i;
      }
      if (is_misspelt_angle(names[i])) {
        return error(fmt::format("column '{}' is not known; did you mean 'angle_deg'?",
                                 printable(names[i])));
      }
    }
    for (const Column needed : {column_u, column_v}) {
      if (header.place[needed] != absent) continue;
      return error(fmt::format(
          "there is no column '{}'; name the columns in the header row, separated by commas",
          column_names[needed]));
    }
    return header;
  }

  // Columns that nobody asks for are ignored, but a recording must not lose its truth to a typo.
  static bool is_misspelt_angle(std::string_view name) {
    const std::string& right = column_names[column_angle];
    return name != right && name.size() < 2 * right.size() && edit_distance(name, right) <= 2;
  }

  std::optional<Error> read_row(const Header& header, std::string_view line,
                                std::vector<RecordedSource::Row>& rows) {
    const std::vector<std::string_view> cells = split_cells(line);
    if (cells.size() != header.width) {
      return error(fmt::format("the row has {} columns and the header {}; complete or remove it",
                               cells.size(), header.width));
    }
    std::array<double, column_count> values{};
    for (size_t column = 0; column < column_count; ++column) {
      if (header.place[column] == absent) continue;
      const Result<double> value = number(cells[header.place[column]], column_names[column]);
      if (!value) return Error{value.error()};
      values[column] = value.value();
    }
    if (header.place[column_time] != absent) {
      if (!rows.empty() && values[column_time] <= last_time_) {
        return error(fmt::format("t = {} does not lie after the row before; sort the rows by time",
                                 values[column_time]));
      }
      if (rows.empty()) first_time_ = values[column_time];
      last_time_ = values[column_time];
    }
    rows.push_back({values[column_u], values[column_v], modulo_turn(values[column_angle] / 360.0)});
    return std::nullopt;
  }

  Result<double> number(std::string_view cell, const std::string& column) const {
    std::string_view digits = cell;
    if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
    double value = 0.0;
    const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (status != std::errc() || end != digits.data() + digits.size()) {
      return error(fmt::format("'{}' in column '{}' is not a number; correct or remove the row",
                               printable(cell), column));
    }
    if (!std::isfinite(value)) {
      return error(fmt::format("'{}' in column '{}' is not finite; remove the row", printable(cell),
                               column));
    }
    return value;
  }

  Description description(size_t rows) const {
    Description description;
    const size_t slash = file_.find_last_of('/');
    description.name = slash == std::string::npos ? file_ : file_.substr(slash + 1);
    description.origin = "recording";
    description.motion = MotionKind::recorded;
    description.samples = rows;
    const double duration = last_time_ - first_time_;
    if (rows > 1 && duration > 0.0 && std::isfinite(duration)) {
      description.sample_rate_hz = static_cast<double>(rows - 1) / duration;
    }
    return description;
  }

  LineReader lines_;
  const std::string& file_;
  double first_time_ = 0.0;
  double last_time_ = 0.0;
};

}  // namespace

RecordedSource::RecordedSource(Description description, std::vector<Row> rows, bool has_truth)
    : description_(std::move(description)), rows_(std::move(rows)), has_truth_(has_truth) {}

std::optional<SensorValue> RecordedSource::sample(uint64_t k, double /*t_seconds*/) {
  if (k >= rows_.size()) return std::nullopt;
  const Row& row = rows_[k];
  SensorValue value;
  value.u = row.u;
  value.v = row.v;
  value.has_truth = has_truth_;
  value.angle_turns = row.angle_turns;
  value.reference_turns = row.angle_turns;
  return value;
}

Result<RecordedSource> read_recording(std::string_view text, const std::string& file) {
  return Reader(text, file).read();
}

}  // namespace capsoc::sensor
