// Line and toggle coverage of the Verilated coprocessor, merged over the runs.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/result.h"

namespace capsoc::regress {

/// Points that cannot be reached, and why. A line of the file: an arithmetic if it holds for that
/// one alone, kind (line, toggle or branch), source file, line number or signal, "#" and the
/// reason.
class CoverageExceptions {
 public:
  static Result<CoverageExceptions> read(const std::string& file);

  bool holds(const std::string& arithmetic, const std::string& kind, const std::string& file,
             unsigned line, const std::string& name) const;

 private:
  struct Entry {
    std::string arithmetic, kind, file, what;  // arithmetic "": both
  };
  std::vector<Entry> entries_;
};

struct RtlCoverage {
  struct Kind {
    std::string name;  ///< "line" (with branches), "toggle"
    uint64_t points = 0, covered = 0, excepted = 0;
    std::vector<std::string> missing;  ///< "file:line name"

    /// Of the points that can be reached; of all, exceptions counted as not covered.
    double percent() const { return share(points - excepted); }
    double percent_of_all() const { return share(points); }

   private:
    double share(uint64_t of) const {
      return of == 0 ? 100 : 100.0 * static_cast<double>(covered) / static_cast<double>(of);
    }
  };
  std::string arithmetic;
  std::vector<Kind> kinds;
};

/// Adds Verilator coverage files point by point; the sum also goes to `merged`, for
/// verilator_coverage. Points outside rtl/*.sv do not count.
Result<RtlCoverage> merge_coverage(const std::string& arithmetic,
                                   const std::vector<std::string>& files, const std::string& merged,
                                   const CoverageExceptions& exceptions);

}  // namespace capsoc::regress
