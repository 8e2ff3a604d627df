// The formats of recordings, by the ending of the file's name.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "metrics/sample_writer.h"

namespace capsoc::metrics {

/// Begins a recording in the format of its name's ending: .wav, .mat, .sds with its metadata, or
/// else CSV. The file grows next to its place until it is finished. An Error: nothing can be
/// written there, or the format does not hold these columns.
Result<std::unique_ptr<SampleWriter>> begin_recording(Recording recording);

/// Every file that a recording of that name becomes, itself first.
std::vector<std::string> files_of_recording(const std::string& path);

}  // namespace capsoc::metrics
