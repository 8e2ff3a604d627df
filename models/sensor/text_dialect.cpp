#include "sensor/text_dialect.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "sensor/text.h"

namespace capsoc::sensor {
namespace {

constexpr char separators[] = {'\t', ';', ',', '|', ' '};
constexpr std::size_t most_shapes = 50;
constexpr std::size_t most_probed = 10'000;

struct Line {
  unsigned long number;
  std::string_view text;
};

using Cells = std::vector<std::string_view>;

/// Digits with one decimal sign, as a text that may be too long or too large for a double.
bool looks_numeric(std::string_view cell, char sign) {
  if (!cell.empty() && (cell.front() == '+' || cell.front() == '-')) cell.remove_prefix(1);
  if (cell == "nan" || cell == "NaN" || cell == "inf" || cell == "Inf") return true;
  std::size_t i = 0, digits = 0;
  const auto run = [&] {
    while (i < cell.size() && cell[i] >= '0' && cell[i] <= '9') ++i, ++digits;
  };
  run();
  if (i < cell.size() && cell[i] == sign) ++i, run();
  if (digits == 0) return false;
  if (i < cell.size() && (cell[i] == 'e' || cell[i] == 'E')) {
    ++i;
    if (i < cell.size() && (cell[i] == '+' || cell[i] == '-')) ++i;
    digits = 0;
    run();
    if (digits == 0) return false;
  }
  return i == cell.size();
}

/// With either sign.
bool is_numeric(std::string_view cell) {
  return looks_numeric(cell, '.') || looks_numeric(cell, ',');
}

/// A cell that another separator would split into numbers alone.
bool hides_numbers(std::string_view cell, char separator) {
  Cells parts;
  for (const char other : separators) {
    if (other == separator || (other == ',' && looks_numeric(cell, ','))) continue;
    split_cells(cell, other, parts);
    if (parts.size() > 1 && std::all_of(parts.begin(), parts.end(), is_numeric)) return true;
  }
  return false;
}

/// Which cells are numbers; nothing if it can be no row of samples.
struct Shape {
  std::size_t width = 0, numbers = 0;
  std::vector<bool> numeric;
  bool operator==(const Shape& other) const {
    return width == other.width && numeric == other.numeric;
  }
};

/// Cells after the last one that holds something: a row may end with a separator.
void drop_empty_end(Cells& cells) {
  while (cells.size() > 1 && cells.back().empty()) cells.pop_back();
}

Shape shape_of(std::string_view line, char separator, std::size_t least) {
  Cells cells;
  split_cells(line, separator, cells);
  drop_empty_end(cells);
  Shape shape;
  for (const std::string_view cell : cells) {
    if (hides_numbers(cell, separator)) return {};
    shape.numeric.push_back(is_numeric(cell));
    shape.numbers += shape.numeric.back() ? 1 : 0;
  }
  if (shape.numbers < least) return {};
  shape.width = cells.size();
  return shape;
}

/// The rows of samples by one separator: the shape that most lines have, and how many.
struct Guess {
  char separator = ',';
  Shape shape;
  std::size_t lines = 0;
};

Guess guess_by(const std::vector<Line>& lines, char separator, std::size_t least) {
  std::vector<std::pair<Shape, std::size_t>> shapes;
  for (const Line& line : lines) {
    const Shape shape = shape_of(line.text, separator, least);
    if (shape.width == 0) continue;
    const auto known = std::find_if(shapes.begin(), shapes.end(),
                                    [&](const auto& other) { return other.first == shape; });
    if (known != shapes.end())
      ++known->second;
    else if (shapes.size() < most_shapes)
      shapes.emplace_back(shape, 1);
  }
  Guess best;
  best.separator = separator;
  for (const auto& [shape, count] : shapes)
    if (count > best.lines) best.shape = shape, best.lines = count;
  return best;
}

/// Without a row of samples: the separator that the first line has most of.
char separator_of_heading(std::string_view line) {
  char best = ',';
  std::ptrdiff_t most = 0;
  for (const char separator : {',', ';', '\t', '|'}) {
    const std::ptrdiff_t count = std::count(line.begin(), line.end(), separator);
    if (count > most) most = count, best = separator;
  }
  return most > 0 || line.find(' ') == std::string_view::npos ? best : ' ';
}

bool is_unit_row(const Cells& cells) {
  bool any = false;
  for (std::string_view cell : cells) {
    if (cell.empty()) continue;
    const bool bracketed =
        (cell.front() == '(' && cell.back() == ')') || (cell.front() == '[' && cell.back() == ']');
    std::string word(cell);
    for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 'a' - 'A') : c;
    const bool known = seconds_in(word) > 0 || word == "v" || word == "volt" || word == "volts" ||
                       word == "mv" || word == "deg" || word == "rad" || word == "%" ||
                       word == "sequence";
    if (!bracketed && !known) return false;
    any = true;
  }
  return any;
}

std::vector<ColumnName> with_units(std::vector<ColumnName> names, const Cells& units) {
  for (std::size_t i = 0; i < names.size() && i < units.size(); ++i) {
    if (!names[i].unit.empty() || units[i].empty()) continue;
    // "(ms)" and "ms" alike.
    const bool bare = units[i].front() != '(' && units[i].front() != '[';
    names[i].unit =
        column_name(bare ? "x(" + std::string(units[i]) + ")" : "x" + std::string(units[i])).unit;
  }
  return names;
}

std::size_t known_in(const std::vector<ColumnName>& names) {
  return static_cast<std::size_t>(std::count_if(names.begin(), names.end(), is_known_column));
}

/// "u [V]" stays one heading where blanks separate.
void join_units(char separator, Cells& cells) {
  if (separator != ' ') return;
  for (std::size_t i = 1; i < cells.size();) {
    const bool unit = !cells[i].empty() && (cells[i].front() == '[' || cells[i].front() == '(');
    if (!unit) {
      ++i;
      continue;
    }
    const char* const begin = cells[i - 1].data();
    const char* const last = cells[i].data() + cells[i].size();
    cells[i - 1] = {begin, static_cast<std::size_t>(last - begin)};
    cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

/// The heading among the lines above the first row: the nearest with as many cells that are not all
/// numbers, or with names that are known.
void find_header(const std::vector<Line>& lines, std::size_t end, TextDialect& dialect) {
  Cells cells, units;
  for (std::size_t i = end; i-- > 0;) {
    split_cells(lines[i].text, dialect.separator, cells);
    drop_empty_end(cells);
    if (i + 1 == end && is_unit_row(cells) && end > 1) {
      units = cells;
      continue;
    }
    join_units(dialect.separator, cells);
    const std::vector<ColumnName> names = column_names(cells);
    const bool words = !std::all_of(cells.begin(), cells.end(), is_numeric);
    const bool fits = cells.size() == dialect.width && words;
    if (!fits && known_in(names) < 2) {
      if (i + 1 < end && units.empty()) break;  // only the two lines above the rows
      continue;
    }
    dialect.names = with_units(names, units);
    dialect.header_line = lines[i].number;
    return;
  }
}

/// A heading that is a comment: "# t u v".
void find_header_in_comment(std::string_view comment, TextDialect& dialect) {
  if (comment.empty()) return;
  Cells cells;
  split_cells(trimmed(comment.substr(1)), dialect.separator, cells);
  join_units(dialect.separator, cells);
  std::vector<ColumnName> names = column_names(cells);
  if (cells.size() == dialect.width && known_in(names) >= 2) dialect.names = std::move(names);
}

}  // namespace

bool is_comment(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.front() == '#' || text.front() == '%';
}

void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  const bool blanks = separator == ' ';
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  std::size_t i = 0;
  const std::size_t end = line.size();
  for (;;) {
    // A tab is its own separator where it separates.
    while (i < end && (line[i] == ' ' || (line[i] == '\t' && separator != '\t'))) ++i;
    if (blanks && i == end && !cells.empty()) return;
    if (i < end && line[i] == '"') {
      std::size_t close = i + 1;
      while (close < end && (line[close] != '"' || (close + 1 < end && line[close + 1] == '"')))
        close += line[close] == '"' ? 2 : 1;
      close = std::min(close, end);
      cells.push_back(trimmed(line.substr(i + 1, close - i - 1)));
      i = std::min(close + 1, end);
      while (i < end && line[i] != separator && !(blanks && blank(line[i]))) ++i;
    } else {
      const std::size_t start = i;
      if (blanks)
        while (i < end && !blank(line[i])) ++i;
      else
        while (i < end && line[i] != separator) ++i;
      std::size_t last = i;
      while (last > start && blank(line[last - 1])) --last;
      cells.push_back(line.substr(start, last - start));
    }
    if (i >= end) return;
    ++i;
  }
}

bool to_number(std::string_view cell, bool decimal_comma, double& value) {
  char copy[64];
  if (decimal_comma && cell.size() < sizeof copy && cell.find(',') != std::string_view::npos &&
      cell.find('.') == std::string_view::npos) {
    std::replace_copy(cell.begin(), cell.end(), copy, ',', '.');
    cell = std::string_view(copy, cell.size());
  }
  if (cell.size() > 1 && cell.front() == '+' && cell[1] != '-') cell.remove_prefix(1);
  const auto [last, status] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return status == std::errc() && last == cell.data() + cell.size();
}

TextDialect find_dialect(std::string_view head, bool single) {
  std::vector<Line> lines;
  std::string_view last_comment;
  char forced = 0;
  const char end = head.find('\n') == std::string_view::npos ? '\r' : '\n';
  for (unsigned long number = 1; !head.empty(); ++number) {
    const std::size_t length = head.find(end);
    std::string_view line = head.substr(0, length);
    head.remove_prefix(length == std::string_view::npos ? head.size() : length + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (is_comment(line)) {
      if (lines.empty() && !trimmed(line).empty()) last_comment = trimmed(line);
      continue;
    }
    // Excel's own: the separator of what follows.
    if (lines.empty() && line.size() == 5 && line.substr(0, 4) == "sep=") {
      forced = line[4];
      continue;
    }
    lines.push_back({number, line});
  }
  TextDialect dialect;
  if (lines.empty()) return dialect;

  Guess best;
  const std::size_t least = single ? 1 : 2;
  for (const char separator : separators) {
    if (forced != 0 && separator != forced) continue;
    const Guess guess = guess_by(lines, separator, least);
    const bool more = guess.lines > best.lines ||
                      (guess.lines == best.lines && guess.shape.numbers > best.shape.numbers);
    if (guess.lines > 0 && more) best = guess;
  }
  // A signal of whole numbers with a decimal comma looks like two: one file has one.
  if (single && best.separator == ',' && best.shape.width == 2 && best.lines > 0) {
    const Guess one = guess_by(lines, ';', 1);
    if (one.shape.width == 1 && one.lines >= best.lines) best = one;
  }
  if (best.lines == 0) {
    dialect.separator = forced != 0 ? forced : separator_of_heading(lines.front().text);
    Cells cells;
    split_cells(lines.front().text, dialect.separator, cells);
    dialect.names = column_names(cells);
    dialect.header_line = lines.front().number;
    dialect.first_row = dialect.header_line + 1;
    dialect.width = cells.size();
    return dialect;
  }
  dialect.separator = best.separator;
  dialect.width = best.shape.width;
  const auto is_row = [&](const Line& line) {
    return shape_of(line.text, best.separator, least) == best.shape;
  };
  const auto first = std::find_if(lines.begin(), lines.end(), is_row);
  dialect.first_row = first->number;
  find_header(lines, static_cast<std::size_t>(first - lines.begin()), dialect);
  if (dialect.names.empty() && !last_comment.empty()) find_header_in_comment(last_comment, dialect);
  // A row that is broken stands between the heading and the rows: it must be named, and not
  // skipped.
  if (dialect.header_line != 0) {
    const bool plain = known_in(dialect.names) >= 2 && dialect.header_line == lines.front().number;
    if (plain && first != lines.begin() + 1) {
      Cells cells;
      split_cells((lines.begin() + 1)->text, dialect.separator, cells);
      if (!is_unit_row(cells)) dialect.first_row = (lines.begin() + 1)->number;
    }
  }

  Cells cells;
  bool points = false, commas = false;
  for (auto line = first; line != lines.end(); ++line) {
    if (!is_row(*line)) continue;
    split_cells(line->text, dialect.separator, cells);
    for (const std::string_view cell : cells) {
      points = points || (looks_numeric(cell, '.') && cell.find('.') != std::string_view::npos);
      commas = commas || (looks_numeric(cell, ',') && cell.find(',') != std::string_view::npos);
    }
  }
  dialect.decimal_comma = commas && !points;
  for (auto line = first; line != lines.end() && dialect.rows.size() < most_probed; ++line) {
    if (!is_row(*line)) continue;
    split_cells(line->text, dialect.separator, cells);
    std::vector<double> numbers;
    for (const std::string_view cell : cells) {
      double value = 0;
      const bool good = to_number(cell, dialect.decimal_comma, value);
      numbers.push_back(good ? value : std::numeric_limits<double>::quiet_NaN());
    }
    numbers.resize(dialect.width, std::numeric_limits<double>::quiet_NaN());
    dialect.rows.push_back(std::move(numbers));
  }
  return dialect;
}

}  // namespace capsoc::sensor
