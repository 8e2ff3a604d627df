#include "view/time_line.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace capsoc::view {
namespace {

constexpr double ps_in_second = 1e12;

/// Numbers by pairs: when, counted from `begin`, and how long.
Json slices_of(const Json& array, const service::Frames& frames, double begin) {
  Json list = Json::array();
  bool is_time = true;
  for (const double number : service::numbers_in(array, frames)) {
    list.push_back(std::llround(is_time ? number - begin : number));
    is_time = !is_time;
  }
  return list;
}

Json shares_of(const Json& array, const service::Frames& frames) {
  Json list = Json::array();
  for (const char byte : service::bytes_in(array, frames))
    list.push_back(static_cast<uint8_t>(byte));
  return list;
}

}  // namespace

void TimeLine::take(const service::Answer& answer) {
  if (!answer.ok()) return;
  shown_ = answer.result;
  shown_["window_s"] = window_s_;
  const auto begin = shown_.at("begin_ps").get<double>();
  for (Json& row : shown_.at("rows")) {
    if (const auto slices = row.find("slices"); slices != row.end())
      *slices = slices_of(*slices, answer.frames, begin);
    if (const auto shares = row.find("shares"); shares != row.end())
      *shares = shares_of(*shares, answer.frames);
  }
}

bool TimeLine::lacks(double beginning_s) const {
  if (!shown_.is_object()) return false;
  const auto begin = shown_.at("begin_ps").get<double>();
  return shown_.at("known_ps").get<double>() > std::max(begin, beginning_s * ps_in_second);
}

}  // namespace capsoc::view
