// Tables of figures for programs: the rows that a report prints, as JSON and CSV.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace capsoc {

/// A field of a row: nothing, a number, or a text.
using Field = std::variant<std::monostate, double, std::string>;

/// Fields by name, in order.
using Fields = std::vector<std::pair<std::string, Field>>;

/// One table of a report. All rows of all tables of a report have the same names.
struct DataTable {
  std::string id;  ///< short name, as --table takes it
  std::string title;
  std::vector<Fields> rows;
};

/// `{"tables": [{"id", "title", "rows": [{name: value, ...}]}]}`; nothing is null.
nlohmann::ordered_json to_json(const std::vector<DataTable>& tables);

/// RFC 4180 with LF: a header, then one line a row; the first column is the table's id.
std::string to_csv(const std::vector<DataTable>& tables);

}  // namespace capsoc
