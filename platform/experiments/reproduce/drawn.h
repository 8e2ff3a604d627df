// Both papers' figures that carry data, as curves for a report.
#pragma once

#include <string>
#include <vector>

#include "base/curve.h"
#include "base/result.h"

namespace capsoc::reproduce {

/// Ours of every such figure whose table (report.h) is chosen; empty: of all. A curve's name is
/// the figure's as `capsoc report --list-figures` has it, a dot, and what the line is; what a paper
/// prints of it itself is named "paper: ...". `traces`: the folder of the traces. An Error: a trace
/// that cannot be read.
Result<Curves> drawn_figures(const std::string& traces, const std::vector<std::string>& chosen);

}  // namespace capsoc::reproduce
