// How the rows of a text are written: separators, decimal sign, heading, what comes before it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sensor/column_roles.h"

namespace capsoc::sensor {

struct TextDialect {
  char separator = ',';  ///< ' ': blanks and tabs, any number of them
  bool decimal_comma = false;
  std::vector<ColumnName> names;  ///< of the header row, with the units of one below; empty: none
  unsigned long header_line = 0;  ///< 0 without
  unsigned long first_row = 1;    ///< line of the first row of samples, or what stands in its place
  std::size_t width = 0;          ///< cells of a row
  /// The numbers of some rows at the beginning, for columns without names; NaN where there is none.
  std::vector<std::vector<double>> rows;
};

/// Looks at the first lines of a text. Lines that begin with # or % and empty ones do not count.
/// `single`: the file has one signal, and so may have rows of one cell.
TextDialect find_dialect(std::string_view head, bool single);

/// Splits a row into its cells, without the quotes and the blanks around them. A doubled quote
/// within quotes stays doubled.
void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// Whether a line stands for nothing: empty, or a comment.
bool is_comment(std::string_view line);

/// The number in a cell; false if it is none. What is no finite number is one here.
bool to_number(std::string_view cell, bool decimal_comma, double& value);

}  // namespace capsoc::sensor
