// Input files: what may be one, and how it is read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "support/result.h"

namespace capsoc {

/// What an input is held against before anything of it is believed.
struct InputLimits {
  std::string advice;  ///< ends the sentence of an error: "name a file that capsoc fit wrote"
  uint64_t largest;    ///< bytes
  bool may_be_empty = false;
};

/// The whole contents of a regular file. Pipes, sockets, devices and directories are refused before
/// a byte is read: a pipe without a writer never ends, and neither does /dev/zero. Error: "path:
/// what is wrong; advice".
Result<std::string> read_input(const std::string& path, const InputLimits& limits);

/// What is behind a UTF-8 byte order mark, which editors on Windows begin a text with; the text
/// itself without one.
std::string_view without_byte_order_mark(std::string_view text);

/// The same checks for what is not read at once: a library, the bytes for a UART.
std::optional<Error> check_input(const std::string& path, const InputLimits& limits);

}  // namespace capsoc
