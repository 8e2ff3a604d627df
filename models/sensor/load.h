#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

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
/// cannot be read at all.
Result<std::unique_ptr<Source>> load(const std::string& path);

}  // namespace capsoc::sensor
