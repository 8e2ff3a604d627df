// When a trace is on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/result.h"
#include "trace/functions.h"

namespace capsoc::trace {

/// An end of a window: an instruction's address, a simulated time, or neither.
struct Bound {
  std::optional<uint32_t> address;
  std::optional<uint64_t> picoseconds;

  /// A function's name, an address (0x...) or seconds; "" is neither. An Error begins with `what`.
  static Result<Bound> parse(const std::string& text, const std::string& what,
                             const Functions& functions);
};

/// The part of a run that is traced. With addresses it opens in front of the instruction at the
/// start and closes in front of the one at the stop, every time they are reached; a time comes
/// once. Without a start it is open from the beginning, without a stop to the end.
class Window {
 public:
  Window(Bound start, Bound stop) : start_(start), stop_(stop) {
    open_ = !start_.address && !start_.picoseconds;
  }

  bool open() const { return open_; }
  /// Whether instruction() is needed.
  bool has_addresses() const { return start_.address || stop_.address; }
  /// Whether time() is needed.
  bool has_times() const { return start_.picoseconds || stop_.picoseconds; }

  /// Simulated time, which never decreases.
  void time(uint64_t picoseconds);
  /// The instruction that is issued next.
  void instruction(uint32_t address);

 private:
  void close();

  Bound start_, stop_;
  bool open_ = false;
  bool over_ = false;  ///< never opens again
};

}  // namespace capsoc::trace
