#include "run/sample_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace capsoc::run {

std::string to_recording(const std::vector<RecordedSample>& samples, const std::string& origin) {
  constexpr double q31 = 2147483648.0;
  const bool truth = std::all_of(samples.begin(), samples.end(),
                                 [](const RecordedSample& sample) { return sample.has_truth; });
  std::string text = fmt::format("# {}\nt,u,v{}\n", origin, truth ? ",angle_deg" : "");
  for (const RecordedSample& sample : samples) {
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{},{},{}", sample.time_s, sample.u / q31, sample.v / q31);
    if (truth) fmt::format_to(out, ",{}", sample.angle_turns * 360);
    text += '\n';
  }
  return text;
}

}  // namespace capsoc::run
