#include "campaign/export.h"

#include <charconv>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "campaign/flat.h"
#include "campaign/stored_campaign.h"

namespace capsoc::campaign {
namespace {

struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<Value>> rows;
};

Value value_of_flag(bool flag) {
  return flag;
}

/// A seed of 63 bits has more digits than a double.
bool is_long_number(const std::string& text) {
  return text.size() > std::numeric_limits<double>::digits10 &&
         text.find_first_not_of("0123456789") == std::string::npos;
}

/// Of an axis: what the run was given.
Value exact_value_of(const std::string& text) {
  return is_long_number(text) ? Value(text) : value_of(text);
}

class Exporter {
 public:
  Exporter(const StoredCampaign& campaign, const ExportOptions& options)
      : campaign_(campaign), options_(options) {
    table_.names = {"run", "key", "ending", "pass"};
    for (const std::string& axis : campaign.plan.axes) table_.names.push_back(axis);
    if (options.all_keys) return;
    for (const Named& each : campaign.judge->metrics()) table_.names.push_back(each.name);
    for (const Named& each : campaign.judge->criteria())
      table_.names.push_back("criterion " + each.name);
  }

  void note_keys(const StoredRun& run) {
    for (const auto& [name, value] : result_of(run)) keys_.insert(name);
  }
  void take_keys() { table_.names.insert(table_.names.end(), keys_.begin(), keys_.end()); }

  void add(const StoredRun& run, const Judged& judged) {
    std::vector<Value> row = {static_cast<double>(run.number), run.row->key, run.row->ending,
                              value_of_flag(judged.pass)};
    for (std::size_t i = 0; i < campaign_.plan.axes.size(); ++i)
      row.push_back(i < run.values.size() ? exact_value_of(run.values[i]) : Value());
    if (options_.all_keys) {
      const FlatResult result = result_of(run);
      for (const std::string& key : keys_) {
        const auto known = result.find(key);
        row.push_back(known != result.end() ? known->second : Value());
      }
    } else {
      for (const auto& metric : judged.metrics) row.push_back(metric ? Value(*metric) : Value());
      for (const bool met : judged.criteria) row.push_back(value_of_flag(met));
    }
    if (options_.times) row.emplace_back(run.row->wall_s);
    table_.rows.push_back(std::move(row));
  }

  Table finish() {
    if (options_.times) table_.names.emplace_back("worker_wall_s");
    return std::move(table_);
  }

 private:
  FlatResult result_of(const StoredRun& run) const {
    FlatResult result = flatten(nlohmann::ordered_json::parse(run.row->result, nullptr, false));
    for (auto each = result.begin(); each != result.end();) {
      const bool host = !options_.times && is_below(each->first, campaign_.work->host_keys());
      each = host || each->first.empty() ? result.erase(each) : std::next(each);
    }
    return result;
  }

  const StoredCampaign& campaign_;
  ExportOptions options_;
  std::set<std::string> keys_;
  Table table_;
};

Result<Table> table_of(const Store& store, const ExportOptions& options) {
  const auto campaign = StoredCampaign::of(store);
  if (!campaign) return Error{campaign.error()};
  Exporter exporter(campaign.value(), options);
  if (options.all_keys) {
    const auto note = [&](const StoredRun& run, const Judged&) { exporter.note_keys(run); };
    if (auto error = campaign.value().each_done(store, note)) return *error;
    exporter.take_keys();
  }
  const auto take = [&](const StoredRun& run, const Judged& judged) { exporter.add(run, judged); };
  if (auto error = campaign.value().each_done(store, take)) return *error;
  return exporter.finish();
}

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

nlohmann::ordered_json json_of(const Value& value) {
  if (const auto* truth = std::get_if<bool>(&value)) return *truth;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* text = std::get_if<std::string>(&value)) {
    uint64_t number = 0;
    const char* const end = text->data() + text->size();
    if (is_long_number(*text) && std::from_chars(text->data(), end, number).ec == std::errc())
      return number;
    return *text;
  }
  return nullptr;
}

}  // namespace

Result<std::string> to_csv(const Store& store, const ExportOptions& options) {
  const auto table = table_of(store, options);
  if (!table) return Error{table.error()};
  std::string text;
  for (std::size_t i = 0; i < table.value().names.size(); ++i)
    text += (i > 0 ? "," : "") + cell(table.value().names[i]);
  text += "\n";
  for (const std::vector<Value>& row : table.value().rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      text += (i > 0 ? "," : "") + (is_null(row[i]) ? "" : cell(to_text(row[i])));
    text += "\n";
  }
  return text;
}

Result<std::string> to_columns(const Store& store, const ExportOptions& options) {
  const auto table = table_of(store, options);
  if (!table) return Error{table.error()};
  nlohmann::ordered_json columns = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < table.value().names.size(); ++i) {
    auto& column = columns[table.value().names[i]] = nlohmann::ordered_json::array();
    for (const std::vector<Value>& row : table.value().rows) column.push_back(json_of(row[i]));
  }
  return columns.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace capsoc::campaign
