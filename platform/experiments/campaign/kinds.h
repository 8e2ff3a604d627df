// The kinds of work that there are.
#pragma once

#include <memory>

#include "campaign/work.h"

namespace capsoc::campaign {

/// `capsoc run`.
std::unique_ptr<Work> make_run_work();
/// `capsoc fit`, on samples of a generated sensor.
std::unique_ptr<Work> make_fit_work();
/// `capsoc regress`: a scenario with a seed.
std::unique_ptr<Work> make_regress_work();

}  // namespace capsoc::campaign
