// Recordings that are text.
#pragma once

#include <functional>
#include <string>

#include "base/result.h"
#include "sensor/recorded_source.h"
#include "sensor/recording_builder.h"
#include "sensor/text_lines.h"

namespace capsoc::sensor {

/// Reads rows until the end of `lines`. Error: one sentence with file and line.
Result<RecordedSource> read_text_recording(TextLines lines, const std::string& file,
                                           const RecordingOptions& options);

/// The same of two files, each of which has one signal and may have its time: U in the first, V in
/// the second. `file` names both.
Result<RecordedSource> read_text_pair(TextLines u, const std::string& u_file, TextLines v,
                                      const std::string& v_file, const std::string& file,
                                      const RecordingOptions& options);

}  // namespace capsoc::sensor
