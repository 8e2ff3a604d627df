#pragma once

#include <memory>
#include <string>

#include "sensor/source.h"
#include "support/result.h"

namespace capsoc::sensor {

/// The signal in a file: a description (.toml) or a recording (.csv). The error is one sentence
/// "file:line: what is wrong; what to do", without a line when the file cannot be read at all.
Result<std::unique_ptr<Source>> load(const std::string& path);

}  // namespace capsoc::sensor
