// A fault drawn by its seed.
#pragma once

#include <string>

#include "base/result.h"
#include "fault/golden.h"
#include "fault/trial_settings.h"

namespace capsoc::fault {

struct Drawn {
  std::string unit, place;
  unsigned bit = 0;
  std::string line;       ///< as capsoc run --inject takes it
  std::size_t start = 0;  ///< the last of Golden::starts before it
};

/// Each bit of the units is as likely as another one, and each time. The same for the same seed,
/// settings and places. An Error: no unit of that name.
Result<Drawn> draw(const TrialSettings& settings, const Golden& golden);

}  // namespace capsoc::fault
