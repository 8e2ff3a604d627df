// Times in the scripts of UARTs and pins.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "base/number.h"

namespace capsoc::serial {

/// "0.5", seconds of simulated time, in picoseconds; nothing where it is none, negative, or later
/// than a run may last (run.simlimit_s).
inline std::optional<uint64_t> script_time(const std::string& text) {
  constexpr double longest_s = 1e6, picoseconds = 1e12;
  const auto seconds = finite_number(text);
  if (!seconds || *seconds < 0 || *seconds > longest_s) return std::nullopt;
  return static_cast<uint64_t>(std::llround(*seconds * picoseconds));
}

}  // namespace capsoc::serial
