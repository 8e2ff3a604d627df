#include "serial/line_watch.h"

#include <fmt/format.h>
#include <re2/re2.h>

#include "base/printable.h"

namespace capsoc::serial {
namespace {

constexpr std::size_t longest_quotation = 200;

using Pattern = std::shared_ptr<const re2::RE2>;

Result<Pattern> compile(const std::string& text, const char* option) {
  if (text.empty()) return Pattern();
  auto pattern = compile_pattern(text);
  if (pattern) return pattern;
  return Error{
      fmt::format("{} {}: is no regular expression ({}); correct it, or put a backslash "
                  "before what is meant literally",
                  option, text, pattern.error())};
}

bool found(const Pattern& pattern, const std::string& line) {
  return pattern != nullptr && re2::RE2::PartialMatch(line, *pattern);
}

}  // namespace

Result<Pattern> compile_pattern(const std::string& text) {
  re2::RE2::Options options;
  options.set_log_errors(false);
  options.set_encoding(re2::RE2::Options::EncodingLatin1);  // bytes, not characters
  auto pattern = std::make_shared<const re2::RE2>(text, options);
  if (pattern->ok()) return Pattern(std::move(pattern));
  return Error{pattern->error()};
}

Result<Patterns> Patterns::make(const std::string& until, const std::string& fail) {
  auto pass = compile(until, "--until-uart");
  if (!pass) return Error{pass.error()};
  auto bad = compile(fail, "--fail-uart");
  if (!bad) return Error{bad.error()};
  return Patterns{std::move(pass.value()), std::move(bad.value())};
}

std::optional<LineWatch::Match> LineWatch::look() const {
  if (found(patterns_.fail, line_)) return Match{true, printable(line_, longest_quotation)};
  if (found(patterns_.until, line_)) return Match{false, printable(line_, longest_quotation)};
  return std::nullopt;
}

std::optional<LineWatch::Match> LineWatch::feed(uint8_t byte, bool dry) {
  const bool ended = byte == '\n';
  if (!ended) line_ += static_cast<char>(byte);
  if (ended && !line_.empty() && line_.back() == '\r') line_.pop_back();
  const bool full = line_.size() >= longest_line;
  if (!ended && !full && !dry) return std::nullopt;
  auto match = look();
  if (ended || full) line_.clear();
  return match;
}

}  // namespace capsoc::serial
