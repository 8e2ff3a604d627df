#include "base/data_table.h"

#include <fmt/format.h>

namespace capsoc {
namespace {

/// A number with all its digits, a text in quotes where it needs them.
std::string cell(const Field& field) {
  if (const auto* number = std::get_if<double>(&field)) return fmt::format("{}", *number);
  if (!std::holds_alternative<std::string>(field)) return "";
  const auto& text = std::get<std::string>(field);
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

nlohmann::ordered_json value(const Field& field) {
  if (const auto* number = std::get_if<double>(&field)) return *number;
  if (const auto* text = std::get_if<std::string>(&field)) return *text;
  return nullptr;
}

}  // namespace

nlohmann::ordered_json to_json(const std::vector<DataTable>& tables) {
  nlohmann::ordered_json j;
  j["tables"] = nlohmann::ordered_json::array();
  for (const DataTable& table : tables) {
    nlohmann::ordered_json t = {{"id", table.id}, {"title", table.title}};
    t["rows"] = nlohmann::ordered_json::array();
    for (const Fields& row : table.rows) {
      nlohmann::ordered_json r = nlohmann::ordered_json::object();
      for (const auto& [name, field] : row) r[name] = value(field);
      t["rows"].push_back(std::move(r));
    }
    j["tables"].push_back(std::move(t));
  }
  return j;
}

std::string to_csv(const std::vector<DataTable>& tables) {
  std::string text;
  for (const DataTable& table : tables)
    for (const Fields& row : table.rows) {
      if (text.empty()) {
        text = "table";
        for (const auto& [name, field] : row) text += "," + name;
        text += "\n";
      }
      text += cell(table.id);
      for (const auto& [name, field] : row) text += "," + cell(field);
      text += "\n";
    }
  return text;
}

}  // namespace capsoc
