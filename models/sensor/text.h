#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "base/result.h"

namespace capsoc::sensor {

/// Without spaces and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// Whether a word is one of some.
bool is_one_of(std::string_view word, std::initializer_list<const char*> words);

/// "file:line: message".
Error error_at(const std::string& file, unsigned long line, const std::string& message);

}  // namespace capsoc::sensor
