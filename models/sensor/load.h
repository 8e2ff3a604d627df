#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sensor/description_keys.h"
#include "sensor/source.h"
#include "support/result.h"

namespace capsoc::sensor {

/// The name of the sensor that is part of the program: traces/soc_eq21.toml as it was at build
/// time.
constexpr const char* built_in_default = "built-in:soc_eq21.toml";

/// The text behind a name "built-in:...", nothing for any other name.
std::optional<std::string_view> built_in(const std::string& name);

/// The signal in a file: a description (.toml) or a recording (.csv), or one that is built in. The
/// error is one sentence "file:line: what is wrong; what to do", without a line when the file
/// cannot be read at all. `keys` are laid over a description; a recording has none and refuses
/// them.
Result<std::unique_ptr<Source>> load(const std::string& path,
                                     const std::vector<KeyValue>& keys = {});

/// The same for a text that came from elsewhere. Its first line that is neither empty nor a comment
/// decides what it is: a table or a key of a description, or the header of a recording.
Result<std::unique_ptr<Source>> load_text(const std::string& text, const std::string& name,
                                          const std::vector<KeyValue>& keys = {});

}  // namespace capsoc::sensor
