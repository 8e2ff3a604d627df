#include "metrics/sample_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <sstream>

#include "support/constants.h"
#include "support/printable.h"

namespace capsoc::metrics {
namespace {

using Out = std::back_insert_iterator<std::string>;

/// Writes a cell; `index` counts samples from 0.
struct Column {
  const char* name;
  void (*write)(Out out, const RecordedSample& sample, std::size_t index);
};

void number(Out out, double value) {
  fmt::format_to(out, "{}", value);
}

template <double Parameters::*member>
void parameter(Out out, const RecordedSample& sample, std::size_t) {
  if (sample.result) number(out, to_values(sample.result->words).*member);
}

template <int32_t RecordedResult::*member>
void fraction(Out out, const RecordedSample& sample, std::size_t) {
  if (sample.result) number(out, (*sample.result).*member / q31);
}

template <uint32_t RecordedResult::*member>
void word(Out out, const RecordedSample& sample, std::size_t) {
  if (sample.result) fmt::format_to(out, "{}", (*sample.result).*member);
}

void true_angle(Out out, const RecordedSample& sample, std::size_t) {
  if (sample.has_truth) number(out, sample.angle_turns * 360);
}

void found_angle(Out out, const RecordedSample& sample, std::size_t) {
  if (sample.result) number(out, sample.result->angle / q32 * 360);
}

void angle_error(Out out, const RecordedSample& sample, std::size_t) {
  if (sample.result && sample.has_truth)
    number(out, turn_difference(sample.result->angle / q32, sample.angle_turns) * 360);
}

constexpr std::array<Column, 20> all = {{
    {"sample", [](Out out, const RecordedSample&, std::size_t k) { fmt::format_to(out, "{}", k); }},
    {"t", [](Out out, const RecordedSample& s, std::size_t) { number(out, s.time_s); }},
    {"u", [](Out out, const RecordedSample& s, std::size_t) { number(out, s.u / q31); }},
    {"v", [](Out out, const RecordedSample& s, std::size_t) { number(out, s.v / q31); }},
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
    {"error_average",
     [](Out out, const RecordedSample& s, std::size_t) {
       if (s.result) number(out, s.result->error_average / q31);
     }},
    {"error_average_word", word<&RecordedResult::error_average>},
    {"status", word<&RecordedResult::status>},
    {"flags", word<&RecordedResult::flags>},
}};

}  // namespace

Result<RecordColumns> record_columns(const std::string& names, const std::string& origin) {
  RecordColumns columns;
  std::istringstream list(names.empty() ? "t,u,v,angle_deg" : names + ",");
  for (std::string name; std::getline(list, name, ',');) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const Column& column) { return name == column.name; });
    if (found == all.end()) {
      std::string known;
      for (const Column& column : all)
        known += std::string(known.empty() ? "" : ", ") + column.name;
      return Error{fmt::format("{}: there is no column '{}'; choose from {}", origin,
                               printable(name), known)};
    }
    const auto place = static_cast<std::size_t>(found - all.begin());
    if (std::count(columns.begin(), columns.end(), place) != 0)
      return Error{fmt::format("{}: column '{}' is there twice; keep one", origin, name)};
    columns.push_back(place);
  }
  return columns;
}

std::string to_recording(const SampleRecord& samples, const std::string& origin,
                         const RecordColumns& columns) {
  const bool truth = std::all_of(samples.begin(), samples.end(),
                                 [](const RecordedSample& sample) { return sample.has_truth; });
  std::vector<const Column*> chosen;
  for (const std::size_t column : columns)
    if (truth || std::strcmp(all.at(column).name, "angle_deg") != 0)
      chosen.push_back(&all.at(column));
  std::string text = fmt::format("# {}\n", origin);
  for (const Column* column : chosen)
    text += std::string(column == chosen.front() ? "" : ",") + column->name;
  text += '\n';
  for (std::size_t k = 0; k < samples.size(); ++k) {
    for (const Column* column : chosen) {
      if (column != chosen.front()) text += ',';
      column->write(std::back_inserter(text), samples[k], k);
    }
    text += '\n';
  }
  return text;
}

}  // namespace capsoc::metrics
