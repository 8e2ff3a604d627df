// A run with a fault, compared with the run without it.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "fault/draw.h"
#include "fault/golden.h"
#include "fault/trial_settings.h"
#include "fault/verdict.h"

namespace capsoc::fault {

struct Outcome {
  Verdict verdict = Verdict::latent;
  std::string by;                 ///< what detected it, or why it is unapplied; ""
  std::optional<uint64_t> after;  ///< samples from the first wrong angle to the detection
  double largest_deg = 0;         ///< the largest error until then
  uint64_t trusted = 0;           ///< wrong angles until then, with VALID and LOCK and no alarm
  double simulated_s = 0;         ///< how long the fault was looked at
  std::string not_simulated;      ///< why no simulation was needed; "": there was one
};

/// From the state before the fault until the answer is known: something detected it, the state is
/// as without it again, or the run is over. In this process, which can perform no other one.
/// `settings` are the golden run's, with the fault (inject.faults). An Error: an input is wrong.
Result<Outcome> try_fault(const run::RunSettings& settings, const TrialSettings& trial,
                          const Drawn& drawn, const Golden& golden, std::string state);

}  // namespace capsoc::fault
