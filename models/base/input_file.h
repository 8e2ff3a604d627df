// Input files: what may be one, and how it is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/result.h"

namespace capsoc {

/// What an input is compared with before anything of it is believed.
struct InputLimits {
  std::string advice;  ///< ends the sentence of an error: "name a file that capsoc fit wrote"
  uint64_t largest;    ///< bytes
  bool may_be_empty = false;
};

/// The whole contents of a regular file. Pipes, sockets, devices and directories are refused before
/// a byte is read: a pipe without a writer never ends, and neither does /dev/zero. Error: "path:
/// what is wrong; advice".
Result<std::string> read_input(const std::string& path, const InputLimits& limits);

/// What is after a UTF-8 byte order mark, which editors on Windows begin a text with; the text
/// itself without one.
std::string_view without_byte_order_mark(std::string_view text);

/// An input that is read piece by piece, after the same checks.
class InputFile {
 public:
  /// Error: as read_input(), and for an empty file where that is not allowed.
  static Result<InputFile> open(const std::string& path, const InputLimits& limits);
  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  InputFile& operator=(InputFile&&) = delete;

  /// The next bytes, at most `size`; 0 at the end. Error: the file cannot be read, or has grown
  /// beyond the limit.
  Result<std::size_t> read(char* bytes, std::size_t size);

 private:
  InputFile(std::string path, InputLimits limits, int descriptor)
      : path_(std::move(path)), limits_(std::move(limits)), descriptor_(descriptor) {}

  std::string path_;
  InputLimits limits_;
  int descriptor_;
  uint64_t taken_ = 0;
};

/// The same checks for what is not read at once: a library, the bytes for a UART.
std::optional<Error> check_input(const std::string& path, const InputLimits& limits);

}  // namespace capsoc
