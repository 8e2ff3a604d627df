// A campaign: a description becomes a plan (plan.h), whose runs worker processes do (engine.h) and
// a store keeps (store.h), one row each under the hash of everything that determines it. What is in
// the store is not done again; reports (report.h) are drawn from the store alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "campaign/plan.h"
#include "campaign/store.h"

namespace capsoc::campaign {

struct RunOptions {
  unsigned jobs = 1;
  Shard shard;
  bool retry = false;  ///< runs without a result (crashed, out of time) count as not done
};

/// Does what the store does not have; the store takes the plan over. Progress goes to stderr. How
/// many runs were done here. Ends early, with what is done in the store, by an Error or by a signal
/// (host::noted_signal()).
Result<uint64_t> perform(const Plan& plan, Store& store, const RunOptions& options);

/// How long the first run takes, seconds; an Error if it does not end in `limit_s`.
Result<double> time_one(const Plan& plan, double limit_s);

/// The rows of `stores` in one; they are of one description and one program. How many were taken.
Result<uint64_t> merge(Store& into, const std::vector<std::string>& stores);

}  // namespace capsoc::campaign
