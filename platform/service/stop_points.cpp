#include "service/stop_points.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <string>

namespace capsoc::service {
namespace {

using debug::StopCause;
using debug::StopPoint;

constexpr std::array<const char*, 5> point_names = {"breakpoint", "hardware_breakpoint", "write",
                                                    "read", "access"};
constexpr std::array<const char*, 9> reason_names = {"attached",   "step",       "interrupted",
                                                     "breakpoint", "watchpoint", "bkpt",
                                                     "lockup",     "beginning",  "end"};

template <std::size_t n>
std::optional<std::size_t> number_of(const Json& name, const std::array<const char*, n>& names) {
  for (std::size_t i = 0; i < n; ++i)
    if (name == Json(names[i])) return i;
  return std::nullopt;
}

struct Point {
  StopPoint kind;
  uint32_t address, size;
};

std::optional<Point> point_in(const Json& given) {
  if (!given.is_object()) return std::nullopt;
  const auto kind = given.find("kind"), address = given.find("address"), size = given.find("size");
  const auto is_word = [](const Json& value) {
    return value.is_number_unsigned() && value.get<uint64_t>() <= UINT32_MAX;
  };
  if (kind == given.end() || address == given.end() || !is_word(*address)) return std::nullopt;
  if (size != given.end() && !is_word(*size)) return std::nullopt;
  const auto number = number_of(*kind, point_names);
  if (!number) return std::nullopt;
  const auto point = static_cast<StopPoint>(*number);
  const uint32_t bytes = size != given.end() ? size->get<uint32_t>() : 4;
  return Point{point, address->get<uint32_t>(), debug::is_breakpoint(point) ? 0 : bytes};
}

}  // namespace

std::optional<Error> set_points(Board& board, const Json& points) {
  if (!points.is_array()) return Error{"points: give a list of objects"};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto point = point_in(points[i]);
    if (point && board.target().set(point->kind, point->address, point->size)) continue;
    Json done = Json::array();
    for (std::size_t k = 0; k < i; ++k) done.push_back(points[k]);
    clear_points(board, done);
    if (point) return Error{fmt::format("{:#010x}: nothing can be watched there", point->address)};
    return Error{
        R"(write a point as {"kind": "breakpoint", "address": 4096} or, with kind write, read )"
        R"(or access, {"kind": "write", "address": 536870912, "size": 4})"};
  }
  return std::nullopt;
}

void clear_points(Board& board, const Json& points) {
  for (const Json& each : points)
    if (const auto point = point_in(each))
      board.target().clear(point->kind, point->address, point->size);
}

Json to_json(const StopCause& cause) {
  return {{"reason", reason_names[static_cast<std::size_t>(cause.kind)]},
          {"point", point_names[static_cast<std::size_t>(cause.point)]},
          {"address", cause.address}};
}

StopCause cause_in(const Json& about) {
  const auto kind = number_of(about.at("reason"), reason_names);
  const auto point = number_of(about.value("point", Json(point_names[0])), point_names);
  return {static_cast<StopCause::Kind>(kind.value_or(0)), static_cast<StopPoint>(point.value_or(0)),
          about.value("address", 0U)};
}

const char* name_of(StopPoint point) {
  return point_names[static_cast<std::size_t>(point)];
}

}  // namespace capsoc::service
