// The kinds of work that there are.
#pragma once

#include <memory>
#include <vector>

#include "campaign/work.h"

namespace capsoc::campaign {

/// `capsoc run`.
std::unique_ptr<Work> make_run_work();
/// `capsoc fit`, on samples of a generated sensor.
std::unique_ptr<Work> make_fit_work();
/// `capsoc regress`: a scenario with a seed.
std::unique_ptr<Work> make_regress_work();
/// A run with a drawn fault, and what became of it (docs/guide/safety.md).
std::unique_ptr<Work> make_fault_work();
/// A command of the user's own, which prints its result as JSON. `settings`: of every run.
std::unique_ptr<Work> make_command_work(const std::vector<Assignment>& settings);

}  // namespace capsoc::campaign
