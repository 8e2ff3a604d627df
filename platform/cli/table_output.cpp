#include "cli/table_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "base/printable.h"
#include "cli/refuse.h"
#include "cli/whole_number.h"
#include "host/console.h"
#include "host/files.h"
#include "report/page.h"
#include "results/results.h"

namespace capsoc::cli {
namespace {

constexpr int schema_version = 1;
constexpr const char* standard_output = "-";

}  // namespace

void TableOutput::add_to(CLI::App& command, TableNames known, bool with_curves) {
  known_ = std::move(known);
  command.add_option("--table", chosen_, "Only these tables; --list-tables names them")
      ->type_name("ID")
      ->allow_extra_args(false);
  command.add_flag("--list-tables", list_, "List the tables");
  command.add_option("--json", json_, "Write the rows as JSON; -: instead of the text")
      ->type_name("FILE");
  command.add_option("--csv", csv_, "Write the rows as CSV; -: instead of the text")
      ->type_name("FILE");
  command.add_option("--html", html_, "Write a report with figures that a browser shows offline")
      ->type_name("FILE")
      ->check(not_empty());
  if (with_curves)
    command.add_flag("--curves", curves_, "Curves in the JSON file, for capsoc report");
}

bool TableOutput::listed() const {
  if (list_)
    for (const auto& [id, title] : known_) host::print("{:<16} {}\n", id, title);
  return list_;
}

std::optional<Error> TableOutput::check(const std::vector<host::FileUse>& inputs) const {
  for (const std::string& id : chosen_) {
    const bool there = std::any_of(known_.begin(), known_.end(),
                                   [&](const auto& table) { return table.first == id; });
    if (there) continue;
    std::string names;
    for (const auto& [name, title] : known_) names += (names.empty() ? "" : ", ") + name;
    return Error{
        fmt::format("--table {}: there is no such table; choose from {}", printable(id), names)};
  }
  if (json_ == standard_output && csv_ == standard_output)
    return Error{"--json and --csv cannot both be -; give one of them a file"};
  std::vector<host::FileUse> uses = inputs;
  if (json_ != standard_output) uses.push_back({host::FileUse::Kind::output, "--json", json_});
  if (csv_ != standard_output) uses.push_back({host::FileUse::Kind::output, "--csv", csv_});
  uses.push_back({host::FileUse::Kind::output, "--html", html_});
  if (auto error = host::check_uses(uses)) return error;
  for (const std::string& place : {json_, csv_, html_})
    if (!place.empty() && place != standard_output)
      if (auto error = host::check_writable(place)) return error;
  return std::nullopt;
}

std::ostream& TableOutput::text() {
  return json_ == standard_output || csv_ == standard_output ? none_ : std::cout;
}

int TableOutput::finish(const std::vector<DataTable>& tables, const std::string& command, int code,
                        const Curves& curves) const {
  const auto error = write(tables, command, curves);
  if (!error) return code;
  return refuse(error->text, code == run::exit_code::pass ? run::exit_code::lost : code);
}

std::optional<Error> TableOutput::write(const std::vector<DataTable>& tables,
                                        const std::string& command, const Curves& curves) const {
  std::vector<host::TextFile> files;
  if (!json_.empty() || !html_.empty()) {
    nlohmann::ordered_json j = {{"schema", schema_version}, {"versions", run::versions()}};
    j["command"] = command;
    for (const std::string& id : chosen_)
      j["command"] = j["command"].get<std::string>() + " --table " + id;
    j.update(to_json(tables));
    if (!curves.empty()) j["curves"] = to_json(curves);
    if (!json_.empty()) files.push_back({json_, run::to_text(j)});
    if (!html_.empty()) files.push_back({html_, report::page_of({{"", std::move(j)}})});
  }
  if (!csv_.empty()) files.push_back({csv_, to_csv(tables)});
  std::vector<host::TextFile> places;
  for (const host::TextFile& file : files) {
    if (file.path == standard_output)
      host::print(std::string_view(file.text));
    else
      places.push_back(file);
  }
  return places.empty() ? std::nullopt : host::write_together(places);
}

}  // namespace capsoc::cli
