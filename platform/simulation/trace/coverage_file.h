// Coverage as lcov's tracefiles have it (geninfo(1), "FILES").
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/result.h"

namespace capsoc::trace {

/// Counts of one source file.
struct FileCoverage {
  struct Function {
    unsigned line = 0;
    uint64_t calls = 0;
  };
  /// A decision of the code: how often it went one way and the other. `block` tells those of one
  /// line apart.
  struct Decision {
    unsigned line = 0, block = 0;
    bool operator<(const Decision& o) const {
      return line != o.line ? line < o.line : block < o.block;
    }
  };
  struct Outcomes {
    uint64_t yes = 0, no = 0;
  };
  std::map<std::string, Function> functions;
  std::map<Decision, Outcomes> decisions;
  std::map<unsigned, uint64_t> lines;

  bool empty() const { return functions.empty() && decisions.empty() && lines.empty(); }
};

/// Counts of a program, in one run of it or in several.
struct ProgramCoverage {
  std::string program;  ///< which one: letters, digits and underscores
  std::map<std::string, FileCoverage> files;

  /// Counts of another run of the same program in addition; they end at 2^64 - 1.
  void add(const ProgramCoverage& other);
};

std::string to_lcov(const ProgramCoverage& coverage);

/// What to_lcov() wrote. An Error names the file and the line.
Result<ProgramCoverage> parse_lcov(const std::string& path, const std::string& text);

}  // namespace capsoc::trace
