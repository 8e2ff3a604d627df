// The result of a run on its way from the worker process that did it.
#pragma once

#include <string>

#include "regress/campaign.h"

namespace capsoc::regress {

std::string to_text(const Run& run, const Coverage& coverage);

/// What to_text() wrote: results into `run`, counts onto `coverage`. false: it is no such text.
bool take_text(const std::string& text, Run& run, Coverage& coverage);

}  // namespace capsoc::regress
