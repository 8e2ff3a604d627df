#pragma once

#include <string>
#include <string_view>

#include "support/result.h"

namespace capsoc::sensor {

/// Without spaces and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// Printable: bytes outside 0x20 .. 0x7E become '?', more than 40 characters are cut with "...".
/// What a damaged file holds must not reach a terminal as it is.
std::string printable(std::string_view text);

/// "file:line: message".
Error error_at(const std::string& file, unsigned long line, const std::string& message);

}  // namespace capsoc::sensor
