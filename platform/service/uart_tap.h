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

namespace re2 {
class RE2;
}

namespace capsoc::service {

class UartTap {
 public:
  /// Bytes that nobody has read. Written as JSON they fit a line, whatever they are.
  static constexpr std::size_t most_kept = std::size_t{2} << 20;

  /// Listens beside whoever has the line already, and answers the receiver before `otherwise`.
  void attach(cmsdk::Uart& uart, std::function<std::optional<uint8_t>()> otherwise);

  /// The host sends bytes, which the UART takes as fast as its receiver can.
  void send(std::string_view bytes);
  std::string waiting() const { return input_.substr(taken_); }

  /// What it sent since the last call. `lost`: bytes before that were dropped as too many.
  std::string take(uint64_t& lost);
  const std::string& unread() const { return output_; }
  void set_unread(std::string text) { output_ = std::move(text); }

  /// Bytes that it sent since the start.
  uint64_t sent() const { return sent_; }
  void set_sent(uint64_t sent) { sent_ = sent; }
  /// What a client knows, or waits unread for it: after going back, bytes before `told` that are
  /// sent again are not told again. A pattern finds them nevertheless.
  struct Told {
    uint64_t told = 0;   ///< bytes since the start
    std::string unread;  ///< of these the last ones
    uint64_t lost = 0;
  };
  Told told() const { return {sent_ > told_ ? sent_ : told_, output_, lost_}; }
  void set_told(Told told);
  /// What follows was never sent before.
  void forget_told() { told_ = sent_; }
  /// Nothing is told until set_told().
  void mute() { told_ = UINT64_MAX; }

  /// Looks for a pattern in what is unread, now and at the end of each line and of each burst;
  /// `on_match` is called once, and everything up to the end of the match counts as read.
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
  void keep(uint8_t byte);
  void match(std::string& text);
  void search();

  cmsdk::Uart* uart_ = nullptr;
  kit::Listening listening_;
  std::string input_, output_, line_;
  std::size_t taken_ = 0;  ///< of input_
  uint64_t lost_ = 0;
  uint64_t sent_ = 0, told_ = 0;
  bool repeats_ = false;  ///< the past is searched: again_ and not output_
  std::string again_;     ///< sent since then, and not matched
  const re2::RE2* pattern_ = nullptr;
  std::function<void()> on_match_;
  std::optional<Match> match_;
};

}  // namespace capsoc::service
