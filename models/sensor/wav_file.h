// Recordings in WAV files.
#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "sensor/column_table.h"

namespace capsoc::sensor {

/// Whether bytes begin as a WAV file does.
bool is_wav(std::string_view bytes);

/// Reads the channels of a RIFF or RF64 file as columns, and the sample rate. PCM of 8, 16, 24 and
/// 32 bits becomes units of full scale; floating point of 32 and 64 bits is not scaled. A file that
/// ends within its data gives the samples before, with a remark. Error: one sentence with the file.
Result<ColumnTable> read_wav(std::string_view bytes, const std::string& file);

}  // namespace capsoc::sensor
