#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "sensor/description_keys.h"
#include "sensor/recording_options.h"
#include "sensor/source.h"

namespace capsoc::sensor {

/// The name of the sensor that is part of the program: traces/soc_eq21.toml as it was at build
/// time.
constexpr const char* built_in_default = "built-in:soc_eq21.toml";

/// The text of a name "built-in:...", nothing for any other name.
std::optional<std::string_view> built_in(const std::string& name);

/// The signal in a file: a description (.toml), a recording as text, WAV, MAT or SDS, or one that
/// is built in. "U.csv,V.csv" are two files of one signal each. The error is one sentence
/// "file:line: what is wrong; what to do", without a line where there is none. `keys` are laid over
/// a description; a recording has none and refuses them, as a description does the `options` of a
/// recording.
Result<std::unique_ptr<Source>> load(const std::string& path,
                                     const std::vector<KeyValue>& keys = {},
                                     const RecordingOptions& options = {});

/// The same for what came from elsewhere. Its first bytes decide what it is: those of a WAV or MAT
/// file, a table or a key of a description, or else a recording as text.
Result<std::unique_ptr<Source>> load_text(const std::string& text, const std::string& name,
                                          const std::vector<KeyValue>& keys = {},
                                          const RecordingOptions& options = {});

/// The files that a name of load() stands for: itself, both of two, an SDS recording and its
/// metadata.
std::vector<std::string> files_of(const std::string& path);

}  // namespace capsoc::sensor
