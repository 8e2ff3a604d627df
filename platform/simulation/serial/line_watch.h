// Ends a run on a line of a UART's output.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/archive.h"
#include "base/result.h"

namespace re2 {
class RE2;
}

namespace capsoc::serial {

/// Compiles a regular expression in RE2 syntax, over bytes without decoding. An Error says why it
/// is invalid.
Result<std::shared_ptr<const re2::RE2>> compile_pattern(const std::string& text);

/// The regular expressions of --until-uart and --fail-uart (RE2 syntax: linear in the text,
/// whatever the guest prints). Bytes are not decoded.
struct Patterns {
  std::shared_ptr<const re2::RE2> until, fail;

  /// An empty text is no pattern. A bad one is an Error that names its option.
  static Result<Patterns> make(const std::string& until, const std::string& fail);
  bool any() const { return until != nullptr || fail != nullptr; }
};

/// Matches each line of one UART when its LF arrives, and an unfinished one when the transmitter
/// becomes empty (a prompt). Matching at every byte would cost the square of the line's length.
class LineWatch {
 public:
  static constexpr std::size_t longest_line = 4096;  ///< longer ones are looked at in pieces

  struct Match {
    bool failed = false;
    std::string line;  ///< for people: printable, cut
  };

  explicit LineWatch(Patterns patterns) : patterns_(std::move(patterns)) {}

  /// `dry`: nothing follows at once. A match, if this byte made one; --fail-uart comes first.
  std::optional<Match> feed(uint8_t byte, bool dry);

  /// The line so far.
  void visit(Archive& archive) { archive("line", line_); }

 private:
  std::optional<Match> look() const;

  Patterns patterns_;
  std::string line_;
};

}  // namespace capsoc::serial
