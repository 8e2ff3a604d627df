// The samples that the coprocessor saw, kept and written as a recording.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace capsoc::run {

/// One sample after quantisation.
struct RecordedSample {
  double time_s = 0;       ///< since the first sample
  int32_t u = 0, v = 0;    ///< Q1.31
  double angle_turns = 0;  ///< true angle; only when has_truth
  bool has_truth = false;
};

/// A recording as `capsoc run` and `capsoc fit` read it (traces/README.md): the columns t, u, v
/// and, if it is known for all samples, angle_deg. Numbers have all their digits, so that u and v
/// become the same words again in a converter of 32 bits.
std::string to_recording(const std::vector<RecordedSample>& samples, const std::string& origin);

}  // namespace capsoc::run
