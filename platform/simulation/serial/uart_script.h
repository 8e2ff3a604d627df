// The outside of a UART as a script: what it sends, and what it expects to hear before it
// continues.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/result.h"
#include "serial/line_watch.h"

namespace capsoc::serial {

/// A line of a script.
struct UartStep {
  enum class Kind : uint8_t { at, wait, expect, send };
  Kind kind = Kind::at;
  unsigned line = 0;
  uint64_t picoseconds = 0;                     ///< at, wait; expect: 0: as long as it takes
  std::string text;                             ///< send: the bytes; expect: the pattern as written
  std::shared_ptr<const re2::RE2> expectation;  ///< of expect
};

/// Parses a script: a step a line, in order; empty lines and those that begin with # do not count.
///
///     at 0.5                      until this simulated time, in seconds
///     wait 0.1                    for so long
///     send "status\r"             bytes; \n \r \t \e \\ \" and \x41 as in C
///     expect /t= *\d+/ within 2   until a line matches (RE2 over bytes), at most so many seconds
///
/// An Error names the line.
Result<std::vector<UartStep>> parse_uart_script(const std::string& file, const std::string& text);

/// Plays a script. Independent of the kernel: the owner passes the time, in picoseconds.
class UartScript {
 public:
  static constexpr std::size_t most_unheard = 65536;  ///< bytes kept for an expectation to come

  /// `option` ("--uart0") is named where the file cannot be read.
  static Result<UartScript> open(const std::string& file, const std::string& option);
  /// An empty script: sends and expects nothing.
  UartScript() = default;
  UartScript(std::string file, std::vector<UartStep> steps);

  /// A byte left the chip's UART; `dry`: nothing follows at once. True: play() has something to do.
  bool sent(uint8_t byte, bool dry);
  /// Does all that is due.
  void play(uint64_t now);
  /// When play() is to be called again though nothing was sent; none: that would change nothing.
  std::optional<uint64_t> next_time() const;
  /// The next byte for the chip's receiver.
  std::optional<uint8_t> next_input();
  bool has_input() const { return taken_ < input_.size(); }

  /// Why it does not continue, a sentence; "" while it does.
  const std::string& failure() const { return failure_; }
  /// The step that it has not done, a sentence; "" when all are.
  std::string unfinished() const;

  void visit(Archive& archive);

 private:
  bool waits() const { return current_ < steps_.size(); }
  const UartStep& step() const { return steps_[current_]; }
  bool is_due(uint64_t now);
  void begin(uint64_t now);
  bool is_heard();

  std::string file_;
  std::vector<UartStep> steps_;
  std::size_t current_ = 0;
  bool begun_ = false;     ///< the current step
  uint64_t begun_at_ = 0;  ///< then: its time
  std::string unheard_;    ///< what the chip sent since the last expectation was met
  bool dry_ = true;        ///< after unheard_ came nothing at once
  bool looks_ = false;     ///< unheard_ may hold what is expected
  std::string input_;
  std::size_t taken_ = 0;
  std::string failure_;
};

}  // namespace capsoc::serial
