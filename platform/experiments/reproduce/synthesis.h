#pragma once

#include <map>
#include <optional>
#include <string>

#include "base/result.h"
#include "reproduce/report.h"

namespace capsoc::reproduce {

/// What scripts/tool synth found for one arithmetic.
struct Area {
  double alms = 0, registers = 0, dsp_blocks = 0;
  /// f_max with routing, MHz: of the slower and the faster assumption. Absent: its timing analysis
  /// was stopped.
  std::optional<double> slowest_mhz, fastest_mhz;
};

/// By the name in scripts/tool synth: "precise", "paper", "two-clocks", or some of them.
using Synthesis = std::map<std::string, Area>;

/// Reads what `scripts/tool synth --json FILE` writes. The error is one sentence that begins with
/// the path: a file that cannot be read, or that is something else.
Result<Synthesis> read_synthesis(const std::string& path);

/// The SoC paper's Table 7 and the frequency that it expects (section 4.3). Without a synthesis the
/// paper's figures stand alone.
void table_7(Report& report, const Synthesis& synthesis);

}  // namespace capsoc::reproduce
