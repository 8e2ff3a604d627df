#include "view/curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace capsoc::view {

const std::vector<std::string>& Curves::columns() {
  static const std::vector<std::string> names = {
      "t",  "u",  "v",  "angle_deg", "found_deg", "error_deg",
      "a1", "a2", "b1", "b2",        "beta_rad",  "error_average"};
  return names;
}

void Curves::add(const service::Answer& answer) {
  const service::Json& read = answer.result.at("columns");
  for (std::size_t c = 0; c < columns().size(); ++c)
    newest_[c] = service::numbers_in(read.at(columns()[c]), answer.frames);
  if (newest_.front().empty()) return;
  const auto& times = all_.front();
  const auto kept = std::lower_bound(times.begin(), times.end(), newest_.front().front());
  const auto count = static_cast<std::size_t>(kept - times.begin());
  for (std::size_t c = 0; c < all_.size(); ++c) {
    all_[c].resize(count);
    all_[c].insert(all_[c].end(), newest_[c].begin(), newest_[c].end());
  }
  while (all_.front().size() > most_points) thin();
}

/// Every second point goes.
void Curves::thin() {
  const std::size_t count = all_.front().size();
  for (auto& column : all_) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; i += i + 1 == count ? 1 : 2) column[kept++] = column[i];
    column.resize(kept);
  }
}

std::string Curves::text_of(const Points& points) {
  fmt::memory_buffer out;
  const auto put = [&out](const auto& text) { out.append(std::string_view(text)); };
  put("{");
  for (std::size_t c = 0; c < points.size(); ++c) {
    fmt::format_to(std::back_inserter(out), "{}\"{}\":[", c == 0 ? "" : ",", columns()[c]);
    bool is_first = true;
    for (const double value : points[c]) {
      if (!is_first) put(",");
      is_first = false;
      if (std::isfinite(value))
        fmt::format_to(std::back_inserter(out), c == 0 ? "{:.9g}" : "{:.6g}", value);
      else
        put("null");
    }
    put("]");
  }
  put("}");
  return fmt::to_string(out);
}

}  // namespace capsoc::view
