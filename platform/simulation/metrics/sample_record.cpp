#include "metrics/sample_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/constants.h"
#include "base/printable.h"
#include "base/split.h"

namespace capsoc::metrics {
namespace {

using Cell = std::optional<double>;

struct Column {
  const char* name;
  Cell (*value)(const RecordedSample& sample, std::size_t index);
};

template <double Parameters::*member>
Cell parameter(const RecordedSample& sample, std::size_t) {
  if (!sample.result) return std::nullopt;
  return to_values(sample.result->words).*member;
}

template <auto RecordedResult::*member>
Cell fraction(const RecordedSample& sample, std::size_t) {
  if (!sample.result) return std::nullopt;
  return (*sample.result).*member / q31;
}

template <uint32_t RecordedResult::*member>
Cell word(const RecordedSample& sample, std::size_t) {
  if (!sample.result) return std::nullopt;
  return (*sample.result).*member;
}

Cell true_angle(const RecordedSample& sample, std::size_t) {
  if (!sample.has_truth) return std::nullopt;
  return sample.angle_turns * 360;
}

Cell found_angle(const RecordedSample& sample, std::size_t) {
  if (!sample.result) return std::nullopt;
  return sample.result->angle / q32 * 360;
}

Cell angle_error(const RecordedSample& sample, std::size_t) {
  if (!sample.result || !sample.has_truth) return std::nullopt;
  return turn_difference(sample.result->angle / q32, sample.angle_turns) * 360;
}

constexpr std::array<Column, 20> columns_known = {{
    {"sample", [](const RecordedSample&, std::size_t k) { return Cell(static_cast<double>(k)); }},
    {"t", [](const RecordedSample& s, std::size_t) { return Cell(s.time_s); }},
    {"u", [](const RecordedSample& s, std::size_t) { return Cell(s.u / q31); }},
    {"v", [](const RecordedSample& s, std::size_t) { return Cell(s.v / q31); }},
    {"angle_deg", true_angle},
    {"found_deg", found_angle},
    {"found_word", word<&RecordedResult::angle>},
    {"error_deg", angle_error},
    {"a1", parameter<&Parameters::a1>},
    {"a2", parameter<&Parameters::a2>},
    {"b1", parameter<&Parameters::b1>},
    {"b2", parameter<&Parameters::b2>},
    {"beta_rad", parameter<&Parameters::beta>},
    {"phi_rad", parameter<&Parameters::phi>},
    {"err_u", fraction<&RecordedResult::error_u>},
    {"err_v", fraction<&RecordedResult::error_v>},
    {"error_average", fraction<&RecordedResult::error_average>},
    {"error_average_word", word<&RecordedResult::error_average>},
    {"status", word<&RecordedResult::status>},
    {"flags", word<&RecordedResult::flags>},
}};

}  // namespace

Result<RecordColumns> record_columns(const std::string& names, const std::string& origin) {
  RecordColumns columns;
  for (const std::string& name : split(names.empty() ? "t,u,v,angle_deg" : names + ",", ',')) {
    const auto found = std::find_if(columns_known.begin(), columns_known.end(),
                                    [&](const Column& column) { return name == column.name; });
    if (found == columns_known.end()) {
      std::string known;
      for (const Column& column : columns_known)
        known += std::string(known.empty() ? "" : ", ") + column.name;
      return Error{fmt::format("{}: there is no column '{}'; choose from {}", origin,
                               printable(name), known)};
    }
    const auto place = static_cast<std::size_t>(found - columns_known.begin());
    if (std::count(columns.begin(), columns.end(), place) != 0)
      return Error{fmt::format("{}: column '{}' is there twice; keep one", origin, name)};
    columns.push_back(place);
  }
  return columns;
}

void RecordedResult::visit(Archive& archive) {
  archive("angle", angle);
  archive("words", words);
  archive("error_u", error_u);
  archive("error_v", error_v);
  archive("error_average", error_average);
  archive("status", status);
  archive("flags", flags);
  archive("angle_valid", angle_valid);
  archive("demodulating", demodulating);
}

const char* column_name(std::size_t column) {
  return columns_known.at(column).name;
}

std::optional<double> column_value(std::size_t column, const RecordedSample& sample,
                                   std::size_t index) {
  return columns_known.at(column).value(sample, index);
}

}  // namespace capsoc::metrics
