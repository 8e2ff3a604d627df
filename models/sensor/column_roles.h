// Which columns of a recording are the two signals, the time and the true angle.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace capsoc::sensor {

enum Role : std::size_t { role_u, role_v, role_angle, role_time, role_count };

enum class AngleUnit { unknown, degrees, radians, turns };

/// A column's heading, taken apart: `u [V]`, `time (ms)`, `angle_deg`.
struct ColumnName {
  std::string text;  ///< as it stands there, without quotes
  std::string key;   ///< letters and digits of the name alone, in lower case: "channel1"
  std::string unit;  ///< in lower case, without brackets, or ""
};
ColumnName column_name(std::string_view heading);
std::vector<ColumnName> column_names(const std::vector<std::string_view>& headings);

constexpr std::size_t no_column = static_cast<std::size_t>(-1);

/// Places of the columns, from 0, and the units of what they hold.
struct ColumnChoice {
  std::array<std::size_t, role_count> place;
  AngleUnit angle = AngleUnit::unknown;
  std::string angle_name = "angle";  ///< for sentences
  double time_unit_s = 1;
  std::string value_unit;  ///< of u

  ColumnChoice() { place.fill(no_column); }
  bool has(Role role) const { return place[role] != no_column; }
};

/// Chooses by `wanted` (RecordingOptions::columns), or else by the columns' names. Error: without
/// file and line; it names the columns that there are, and the option.
Result<ColumnChoice> choose_columns(const std::vector<ColumnName>& names,
                                    const std::string& wanted);

/// The same for columns without names, of which the first rows are known (`rows[k][column]`). Two
/// columns are u and v. If the first one rises, three are t, u and v, and four are t, u, v and the
/// angle.
Result<ColumnChoice> choose_nameless(std::size_t columns,
                                     const std::vector<std::vector<double>>& rows,
                                     const std::string& wanted);

/// The one signal of a file that has no other, as role_u, and its time.
Result<ColumnChoice> choose_single(const std::vector<ColumnName>& names, const std::string& wanted);

/// "'t', 'ch 1', 'ch 2'", at most a dozen of them.
std::string listed(const std::vector<ColumnName>& names);

/// Whether a heading is one that choose_columns() knows, of any role.
bool is_known_column(const ColumnName& name);

/// Seconds in a unit of time ("ms"), or 0 if it is none.
double seconds_in(std::string_view unit);

}  // namespace capsoc::sensor
