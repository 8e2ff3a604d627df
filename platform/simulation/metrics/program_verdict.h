// What a program says of its own results: the object `program_verdict` of
// firmware/common/program_verdict.h.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "loader/elf_image.h"
#include "metrics/metrics.h"

namespace capsoc::metrics {

/// The verdict of a program, and the result of its comparison with the truth.
struct ProgramVerdict {
  bool pass = false;
  double bound_deg = 0;  ///< with pass: no angle is said to be further from the truth
  /// With pass, if the program limits it: the number of last samples that the verdict covers.
  std::optional<uint64_t> samples;
  std::optional<double> motion_deg;     ///< with pass: of the shaft from sample to sample
  std::vector<std::string> conditions;  ///< with pass: what it assumes, for a reader
  std::string reason;                   ///< with fail
  /// Largest error of the angles that the bound covers, degrees: those of `samples`, else those of
  /// calibration mode, else those of the last turn of demodulation. Empty if the truth is not
  /// known.
  std::optional<double> largest_error_deg;

  /// Empty without a bound or without the truth.
  std::optional<bool> bound_holds() const {
    if (!pass || !largest_error_deg) return std::nullopt;
    return *largest_error_deg <= bound_deg;
  }
};

/// Reads memory of the guest as it is; false where there is none.
using ReadMemory = std::function<bool(uint32_t address, void* bytes, uint32_t size)>;

/// Empty if the program has no such object, has no verdict yet, or the object is not valid.
std::optional<ProgramVerdict> read_verdict(const loader::ElfImage& program, const ReadMemory& read,
                                           const Metrics& metrics);

}  // namespace capsoc::metrics
