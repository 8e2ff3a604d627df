// A UART of the board as a session has it: all that it sent, and bytes that wait for its receiver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cmsdk/uart.h"
#include "kit/probe.h"
#include "serial/kept_stream.h"

namespace re2 {
class RE2;
}

namespace capsoc::service {

class UartTap {
 public:
  /// Listens in addition to the present listener of the line, and answers the receiver before
  /// `otherwise`.
  void attach(cmsdk::Uart& uart, std::function<std::optional<uint8_t>()> otherwise);

  /// The host sends bytes, which the UART takes as fast as its receiver can.
  void send(std::string_view bytes);
  std::string waiting() const { return input_.substr(taken_); }

  /// What it sent since the last call. `lost`: bytes before that were dropped as too many.
  std::string take(uint64_t& lost);
  /// What it sent. After going back, bytes that are sent again are not kept again; a pattern finds
  /// them nevertheless.
  serial::KeptStream& output() { return output_; }
  const serial::KeptStream& output() const { return output_; }
  /// After output().set_told().
  void search_what_is_sent_again();

  /// Searches the unread text for a pattern, now and at the end of each line and of each burst.
  /// Calls `on_match` once; everything up to the end of the match then counts as read.
  void expect(const re2::RE2* pattern, std::function<void()> on_match);
  void forget_pattern() { pattern_ = nullptr; }
  /// Of the last match: the text up to its end, and its groups, the whole match first.
  struct Match {
    std::string text;
    std::vector<std::optional<std::string>> groups;
  };
  const std::optional<Match>& match() const { return match_; }
  /// Called for each line that it sent, without its end.
  std::function<void(const std::string& line)> on_line;

 private:
  void transmitted(uint8_t byte);
  void search();

  cmsdk::Uart* uart_ = nullptr;
  kit::Listening listening_;
  serial::KeptStream output_;
  std::string input_, line_;
  std::size_t taken_ = 0;  ///< of input_
  bool repeats_ = false;   ///< the past is searched: again_ and not output_
  std::string again_;      ///< sent since then, and not matched
  const re2::RE2* pattern_ = nullptr;
  std::function<void()> on_match_;
  std::optional<Match> match_;
};

}  // namespace capsoc::service
