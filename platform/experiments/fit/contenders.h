// The methods on a record, each by its answer alone: without gates and intervals.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "identification/samples.h"

namespace capsoc::fit {

struct Contender {
  std::string name;  ///< as `capsoc fit --method` has it
  /// Canonical parameters at the record's end, or why there are none.
  std::function<Result<identification::Parameters>(const identification::Samples&)> identify;
  bool of_the_papers;  ///< one of those that they name in addition to their own
                       ///< (identification/peers.h)
};

/// The CSFN's trainings, the ellipse fits, and those that the papers name, in this order.
std::vector<Contender> contenders();

}  // namespace capsoc::fit
