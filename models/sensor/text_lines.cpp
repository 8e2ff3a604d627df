#include "sensor/text_lines.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace capsoc::sensor {
namespace {

constexpr std::size_t piece_of_file = 1U << 20U;
// A row of a recording is shorter; a file without line ends is no text.
constexpr std::size_t longest_line = 1U << 20U;
constexpr std::size_t looked_at = 1U << 16U;

/// UTF-16 to Latin-1; `low` is the place of the low byte in two.
void append_latin(std::string_view wide, int low, std::string& out) {
  for (std::size_t i = 0; i + 1 < wide.size(); i += 2) {
    const char high = wide[i + static_cast<std::size_t>(1 - low)];
    out += high == 0 ? wide[i + static_cast<std::size_t>(low)] : '?';
  }
}

/// Place of the low byte where a text begins with a mark of UTF-16; -1 without.
int utf16_mark(std::string_view text) {
  if (text.substr(0, 2) == "\xFF\xFE") return 0;
  return text.substr(0, 2) == "\xFE\xFF" ? 1 : -1;
}

}  // namespace

Result<TextLines> TextLines::open(const std::string& path, const InputLimits& limits) {
  auto file = InputFile::open(path, limits);
  if (!file) return Error{file.error()};
  TextLines lines(std::move(file.value()), path);
  if (lines.error_) return *lines.error_;
  return lines;
}

TextLines::TextLines(InputFile file, std::string path)
    : file_(std::move(file)), path_(std::move(path)) {
  fill();
  begin();
}

TextLines::TextLines(std::string_view text) : text_(text), at_end_(true) {
  wide_ = utf16_mark(text);
  if (wide_ >= 0) {
    append_latin(text.substr(2), wide_, converted_);
    // The object may move, and a view of a short string would not follow.
    converted_.reserve(64);
    text_ = converted_;
  }
  begin();
}

void TextLines::begin() {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (view().substr(0, 3) == byte_order_mark) begin_ = 3;
  const std::string_view first = rest().substr(0, looked_at);
  if (first.find('\n') == std::string_view::npos && first.find('\r') != std::string_view::npos)
    end_ = '\r';
}

std::string_view TextLines::head() const {
  const std::string_view all = rest();
  std::string_view first = all.substr(0, looked_at);
  if (first.size() == all.size() && at_end_) return first;
  const std::size_t last = first.rfind(end_);
  return first.substr(0, last == std::string_view::npos ? first.size() : last + 1);
}

/// Adds a piece_of_file of the file after what is left; false at its end.
bool TextLines::fill() {
  if (at_end_) return false;
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t before = buffer_.size();
  const bool first = before == 0 && number_ == 0;
  std::string bytes = std::move(odd_);
  odd_.clear();
  std::string& into = wide_ >= 0 ? bytes : buffer_;
  const std::size_t kept = into.size();
  into.resize(kept + piece_of_file);
  const auto got = file_->read(into.data() + kept, piece_of_file);
  into.resize(kept + (got ? got.value() : 0));
  if (!got) error_ = Error{got.error()};
  if (!got || got.value() == 0) {
    at_end_ = true;
    return false;
  }
  if (first && wide_ < 0) {
    wide_ = utf16_mark(buffer_);
    if (wide_ >= 0) bytes = buffer_.substr(2), buffer_.clear();
  }
  if (wide_ >= 0) {
    append_latin(bytes, wide_, buffer_);
    if (bytes.size() % 2 != 0) odd_ = bytes.substr(bytes.size() - 1);
  }
  return true;
}

bool TextLines::next(std::string_view& line) {
  std::size_t searched = 0;
  for (;;) {
    const std::string_view left = rest();
    const std::size_t length = left.find(end_, searched);
    if (length != std::string_view::npos || (at_end_ && !left.empty())) {
      line = left.substr(0, length);
      begin_ += length == std::string_view::npos ? left.size() : length + 1;
      ++number_;
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      return true;
    }
    if (at_end_) return false;
    if (left.size() > longest_line) {
      error_ = Error{path_ + ":" + std::to_string(number_ + 1) +
                     ": the line is longer than a megabyte; this is no text of a recording"};
      return false;
    }
    searched = left.size();
    if (!fill() && error_) return false;
  }
}

}  // namespace capsoc::sensor
