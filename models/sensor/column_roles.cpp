#include "sensor/column_roles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>

#include "base/nearest.h"
#include "base/printable.h"
#include "sensor/text.h"

namespace capsoc::sensor {
namespace {

constexpr const char* choice_advice =
    "name those of the sine and the cosine with --columns U,V or --columns T,U,V,ANGLE "
    "(names, or numbers from 1)";

// Sine first. What is called x and y is as often the other way round, and so not in the list.
constexpr std::pair<const char*, const char*> pairs[] = {{"u", "v"},
                                                         {"sin", "cos"},
                                                         {"sine", "cosine"},
                                                         {"sinus", "cosinus"},
                                                         {"s", "c"},
                                                         {"ch1", "ch2"},
                                                         {"channel1", "channel2"},
                                                         {"cha", "chb"},
                                                         {"channela", "channelb"},
                                                         {"a", "b"},
                                                         {"c1", "c2"},
                                                         {"1", "2"},
                                                         {"ch0", "ch1"},
                                                         {"channel0", "channel1"},
                                                         {"adc1", "adc2"},
                                                         {"adc0", "adc1"},
                                                         {"ain1", "ain2"},
                                                         {"ain0", "ain1"},
                                                         {"ai1", "ai2"},
                                                         {"ai0", "ai1"},
                                                         {"in1", "in2"},
                                                         {"in0", "in1"},
                                                         {"u1", "u2"},
                                                         {"v1", "v2"},
                                                         {"voltage", "voltage0"},
                                                         {"voltage0", "voltage1"}};

AngleUnit angle_unit(std::string_view unit) {
  if (is_one_of(unit, {"deg", "degree", "degrees", "\u00b0", "grad"})) return AngleUnit::degrees;
  if (is_one_of(unit, {"rad", "radian", "radians"})) return AngleUnit::radians;
  if (is_one_of(unit, {"turn", "turns", "rev", "revolutions"})) return AngleUnit::turns;
  return AngleUnit::unknown;
}

bool is_time(const ColumnName& name) {
  return is_one_of(name.key, {"t", "time", "times", "timestamp", "timestamps", "seconds", "second",
                              "sec", "zeit", "xaxis", "xvalue", "elapsed", "elapsedtime", "millis",
                              "micros", "ms", "us", "ns", "timeslot"});
}

bool is_angle(const ColumnName& name) {
  return is_one_of(name.key, {"angle", "theta", "trueangle", "angletrue", "refangle", "angleref",
                              "referenceangle", "winkel"});
}

/// Of a time's column, also where the name says it: "millis".
double time_unit(const ColumnName& name) {
  if (const double unit = seconds_in(name.unit); unit > 0) return unit;
  if (is_one_of(name.key, {"millis", "ms"})) return 1e-3;
  if (is_one_of(name.key, {"micros", "us"})) return 1e-6;
  return name.key == "ns" ? 1e-9 : 1;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// Takes the unit off the end: in brackets, or after the last underscore or blank.
std::string split_unit(std::string& name) {
  for (const char* brackets : {"[]", "()"}) {
    const std::size_t open = name.rfind(brackets[0]);
    if (open == std::string::npos || name.empty() || name.back() != brackets[1]) continue;
    std::string unit = lower(trimmed(name.substr(open + 1, name.size() - open - 2)));
    name.resize(open);
    return unit;
  }
  const std::size_t mark = name.find_last_of("_ /");
  if (mark == std::string::npos) return "";
  std::string unit = lower(trimmed(std::string_view(name).substr(mark + 1)));
  const bool known = seconds_in(unit) > 0 || angle_unit(unit) != AngleUnit::unknown ||
                     is_one_of(unit, {"v", "mv", "volt", "volts", "percent", "pct", "%"});
  // "v_s" is no time; "sin_v" would hide no name.
  if (!known || mark == 0) return "";
  name.resize(mark);
  return unit;
}

/// A part of --columns: a name or a number, and a unit.
struct Wanted {
  std::string text, unit;
  bool absent() const { return text.empty() || text == "-"; }
};

std::vector<Wanted> wanted_columns(const std::string& text) {
  std::vector<Wanted> parts;
  for (std::size_t start = 0;;) {
    const std::size_t comma = text.find(',', start);
    std::string part(trimmed(std::string_view(text).substr(start, comma - start)));
    Wanted wanted{part, ""};
    const std::size_t colon = part.rfind(':');
    if (colon != std::string::npos) {
      const std::string unit = lower(part.substr(colon + 1));
      if (seconds_in(unit) > 0 || angle_unit(unit) != AngleUnit::unknown)
        wanted = {part.substr(0, colon), unit};
    }
    parts.push_back(std::move(wanted));
    if (comma == std::string::npos) return parts;
    start = comma + 1;
  }
}

/// The column that a part of --columns means: as it stands there, by its letters, by its number.
Result<std::size_t> find_wanted(const std::vector<ColumnName>& names, const Wanted& wanted) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].text == wanted.text) return i;
  const std::string key = column_name(wanted.text).key;
  std::vector<std::size_t> alike;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!key.empty() && names[i].key == key) alike.push_back(i);
  if (alike.size() == 1) return alike.front();
  const bool digits = !wanted.text.empty() && wanted.text.size() < 6 &&
                      wanted.text.find_first_not_of("0123456789") == std::string::npos;
  if (digits) {
    const auto number = static_cast<std::size_t>(std::stoul(wanted.text));
    if (number >= 1 && number <= names.size()) return number - 1;
  }
  return Error{fmt::format("--columns: there is no column '{}'; the columns are {}",
                           printable(wanted.text), listed(names))};
}

Result<ColumnChoice> choose_wanted(const std::vector<ColumnName>& names, const std::string& text,
                                   std::vector<Role> order) {
  const std::vector<Wanted> parts = wanted_columns(text);
  ColumnChoice choice;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Role role = order[i];
    if (parts[i].absent() && (role == role_time || role == role_angle)) continue;
    const auto place = find_wanted(names, parts[i]);
    if (!place) return Error{place.error()};
    for (const std::size_t other : choice.place)
      if (other == place.value())
        return Error{fmt::format("--columns: column '{}' is there twice; keep one",
                                 printable(names[other].text))};
    choice.place[role] = place.value();
    ColumnName name = names[place.value()];
    if (!parts[i].unit.empty()) name.unit = parts[i].unit;
    if (role == role_u) choice.value_unit = name.unit;
    if (role == role_time) choice.time_unit_s = time_unit(name);
    if (role == role_angle) choice.angle = angle_unit(name.unit), choice.angle_name = name.text;
  }
  return choice;
}

/// The place of a name: of the only column that has it. An Error: several have.
Result<std::size_t> place_of(const std::vector<ColumnName>& names, std::string_view key) {
  std::size_t found = no_column;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].key != key) continue;
    if (found != no_column && names[i].text == names[found].text)
      return Error{fmt::format("column '{}' appears twice; keep one, or choose with --columns",
                               printable(names[i].text))};
    // The name as capsoc writes it comes before one that only looks like it.
    if (found == no_column || names[i].text == key) found = i;
  }
  return found;
}

Result<std::pair<std::size_t, std::size_t>> pair_of(const std::vector<ColumnName>& names,
                                                    std::string_view one, std::string_view other) {
  const auto u = place_of(names, one), v = place_of(names, other);
  if (!u) return Error{u.error()};
  if (!v) return Error{v.error()};
  return std::make_pair(u.value(), v.value());
}

/// Columns that differ only in "sin" and "cos": "adc_sin", "adc_cos".
std::pair<std::size_t, std::size_t> sine_and_cosine(const std::vector<ColumnName>& names) {
  std::pair<std::size_t, std::size_t> found = {no_column, no_column};
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string key = names[i].key;
    const std::size_t place = key.find("sin");
    if (place == std::string::npos) continue;
    key.replace(place, 3, "cos");
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k].key != key) continue;
      if (found.first != no_column)
        return {no_column, no_column};  // two pairs: either may be meant
      found = {i, k};
    }
  }
  return found;
}

Result<std::pair<std::size_t, std::size_t>> signals(const std::vector<ColumnName>& names) {
  for (const auto& [one, other] : pairs) {
    auto found = pair_of(names, one, other);
    if (!found) return found;
    if (found.value().first != no_column && found.value().second != no_column) return found;
  }
  return sine_and_cosine(names);
}

/// Columns that no one asks for are ignored, but a recording must not lose its truth to a typo.
std::optional<Error> misspelt_angle(const std::vector<ColumnName>& names) {
  const std::string right = "angle_deg";
  for (const ColumnName& name : names) {
    const std::string text = lower(name.text);
    if (is_angle(name) || text.size() >= 2 * right.size() || edit_distance(text, right) > 2)
      continue;
    return Error{
        fmt::format("column '{}' is not known; did you mean 'angle_deg'?", printable(name.text))};
  }
  return std::nullopt;
}

std::optional<Error> add_time_and_angle(const std::vector<ColumnName>& names,
                                        ColumnChoice& choice) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i == choice.place[role_u] || i == choice.place[role_v]) continue;
    const bool exact = names[i].text == "t" || names[i].text == "angle_deg";
    for (const Role role : {role_time, role_angle}) {
      if (role == role_time ? !is_time(names[i]) : !is_angle(names[i])) continue;
      if (choice.has(role) && names[choice.place[role]].text == names[i].text)
        return Error{fmt::format("column '{}' appears twice; keep one, or choose with --columns",
                                 printable(names[i].text))};
      if (!choice.has(role) || exact) choice.place[role] = i;
    }
  }
  if (choice.has(role_time)) choice.time_unit_s = time_unit(names[choice.place[role_time]]);
  if (choice.has(role_angle)) {
    choice.angle = angle_unit(names[choice.place[role_angle]].unit);
    choice.angle_name = names[choice.place[role_angle]].text;
  }
  return std::nullopt;
}

/// As a clock does, and no signal for long: without a fall, and as steeply at the end as before.
bool rises(const std::vector<std::vector<double>>& rows) {
  if (rows.size() < 3) return false;
  for (std::size_t k = 1; k < rows.size(); ++k)
    if (!(rows[k].front() >= rows[k - 1].front())) return false;
  const double all = rows.back().front() - rows.front().front();
  const std::size_t middle = (rows.size() - 1) / 2;
  const double half = rows[middle].front() - rows.front().front();
  const double expected = all * static_cast<double>(middle) / static_cast<double>(rows.size() - 1);
  return all > 0 && std::fabs(half - expected) < 0.1 * all;
}

std::vector<ColumnName> numbered(std::size_t columns) {
  std::vector<ColumnName> names;
  for (std::size_t i = 1; i <= columns; ++i)
    names.push_back({std::to_string(i), std::to_string(i), ""});
  return names;
}

}  // namespace

double seconds_in(std::string_view unit) {
  if (is_one_of(unit, {"s", "sec", "second", "seconds"})) return 1;
  if (is_one_of(unit, {"ms", "msec", "millisecond", "milliseconds"})) return 1e-3;
  if (is_one_of(unit, {"us", "usec", "\u00b5s", "\u03bcs", "microsecond", "microseconds"}))
    return 1e-6;
  if (is_one_of(unit, {"ns", "nsec", "nanosecond", "nanoseconds"})) return 1e-9;
  if (is_one_of(unit, {"min", "minutes"})) return 60;
  return 0;
}

ColumnName column_name(std::string_view heading) {
  ColumnName name;
  name.text = std::string(trimmed(heading));
  std::string rest = name.text;
  name.unit = split_unit(rest);
  for (const char c : rest)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 && static_cast<unsigned char>(c) < 0x80)
      name.key += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

std::vector<ColumnName> column_names(const std::vector<std::string_view>& headings) {
  std::vector<ColumnName> names;
  names.reserve(headings.size());
  for (const std::string_view heading : headings) names.push_back(column_name(heading));
  return names;
}

std::string listed(const std::vector<ColumnName>& names) {
  constexpr std::size_t most = 12;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < most; ++i)
    text += fmt::format("{}'{}'", i == 0 ? "" : ", ", printable(names[i].text));
  if (names.size() > most) text += fmt::format(" and {} more", names.size() - most);
  return text;
}

bool is_known_column(const ColumnName& name) {
  if (is_time(name) || is_angle(name)) return true;
  if (name.key.find("sin") != std::string::npos || name.key.find("cos") != std::string::npos)
    return true;
  // Bare numbers are a heading only next to a time's.
  return std::any_of(std::begin(pairs), std::end(pairs), [&](const auto& pair) {
    return name.key != "1" && name.key != "2" &&
           (name.key == pair.first || name.key == pair.second);
  });
}

Result<ColumnChoice> choose_columns(const std::vector<ColumnName>& names,
                                    const std::string& wanted) {
  if (!wanted.empty()) {
    static const std::vector<Role> orders[] = {
        {role_u, role_v}, {role_time, role_u, role_v}, {role_time, role_u, role_v, role_angle}};
    const std::size_t count = wanted_columns(wanted).size();
    if (count < 2 || count > 4)
      return Error{fmt::format("--columns has {} {}; give U,V or T,U,V or T,U,V,ANGLE", count,
                               count == 1 ? "part" : "parts")};
    return choose_wanted(names, wanted, orders[count - 2]);
  }
  const auto found = signals(names);
  if (!found) return Error{found.error()};
  if (found.value().first == no_column || found.value().second == no_column)
    return Error{fmt::format("the columns are {}; {}", listed(names), choice_advice)};
  ColumnChoice choice;
  choice.place[role_u] = found.value().first;
  choice.place[role_v] = found.value().second;
  choice.value_unit = names[choice.place[role_u]].unit;
  if (auto error = add_time_and_angle(names, choice)) return *error;
  if (auto error = misspelt_angle(names)) return *error;
  return choice;
}

Result<ColumnChoice> choose_nameless(std::size_t columns,
                                     const std::vector<std::vector<double>>& rows,
                                     const std::string& wanted) {
  if (!wanted.empty()) return choose_columns(numbered(columns), wanted);
  ColumnChoice choice;
  if (columns == 2) {
    choice.place[role_u] = 0;
    choice.place[role_v] = 1;
    return choice;
  }
  if ((columns == 3 || columns == 4) && rises(rows)) {
    choice.place[role_time] = 0;
    choice.place[role_u] = 1;
    choice.place[role_v] = 2;
    if (columns == 4) choice.place[role_angle] = 3;
    return choice;
  }
  return Error{fmt::format("there are {} columns and no header row; {}", columns, choice_advice)};
}

Result<ColumnChoice> choose_single(const std::vector<ColumnName>& names,
                                   const std::string& wanted) {
  if (!wanted.empty()) {
    static const std::vector<Role> orders[] = {{role_u}, {role_time, role_u}};
    const std::size_t count = wanted_columns(wanted).size();
    if (count > 2)
      return Error{fmt::format(
          "--columns has {} parts, and of two files with a signal each it is VALUE or T,VALUE",
          count)};
    return choose_wanted(names, wanted, orders[count - 1]);
  }
  ColumnChoice choice;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (is_time(names[i]) && !choice.has(role_time)) {
      choice.place[role_time] = i;
      choice.time_unit_s = time_unit(names[i]);
    } else if (!choice.has(role_u)) {
      choice.place[role_u] = i;
      choice.value_unit = names[i].unit;
    } else {
      return Error{
          fmt::format("the columns are {}; of two files with a signal each, choose by "
                      "--columns VALUE or --columns T,VALUE (names, or numbers from 1)",
                      listed(names))};
    }
  }
  if (!choice.has(role_u)) return Error{"there is no column of a signal; only the time's"};
  return choice;
}

}  // namespace capsoc::sensor
