// The lines of a text, whatever its size.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/input_file.h"
#include "base/result.h"

namespace capsoc::sensor {

/// Lines of a file, a megabyte of it in memory at a time, or of a text that is there already. UTF-8
/// with or without a mark; UTF-16 with one (what is beyond Latin-1 becomes '?'). A line ends with
/// LF, CR LF, or CR alone where the text has no LF.
class TextLines {
 public:
  /// Error: as InputFile::open(), or it cannot be read.
  static Result<TextLines> open(const std::string& path, const InputLimits& limits);
  explicit TextLines(std::string_view text);

  /// The whole lines among the first bytes, to look at before the first next(); without a last line
  /// that is cut off.
  std::string_view head() const;

  /// The next line without its end. False after the last, and when reading failed: see error().
  bool next(std::string_view& line);
  /// Of the last line, from 1.
  unsigned long number() const { return number_; }
  /// Why there are no more lines, without one if the text is at its end.
  const std::optional<Error>& error() const { return error_; }

 private:
  explicit TextLines(InputFile file, std::string path);
  void begin();
  bool fill();
  void from_utf16();
  std::string_view rest() const { return view().substr(begin_); }
  std::string_view view() const { return file_ ? std::string_view(buffer_) : text_; }

  std::optional<InputFile> file_;
  std::string path_;
  std::string buffer_;  ///< of a file
  std::string_view text_;
  std::string converted_;
  std::size_t begin_ = 0;
  unsigned long number_ = 0;
  char end_ = '\n';
  bool at_end_ = false;
  int wide_ = -1;  ///< place of the low byte in two; -1: UTF-8
  std::string odd_;
  std::optional<Error> error_;
};

}  // namespace capsoc::sensor
