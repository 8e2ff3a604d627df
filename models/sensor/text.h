#pragma once

#include <string>
#include <string_view>

#include "support/result.h"

namespace capsoc::sensor {

/// Without spaces and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// "file:line: message".
Error error_at(const std::string& file, unsigned long line, const std::string& message);

}  // namespace capsoc::sensor
