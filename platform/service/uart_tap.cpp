#include "service/uart_tap.h"

#include <re2/re2.h>

#include <utility>
#include <vector>

namespace capsoc::service {
namespace {

constexpr std::size_t longest_line = 4096;    // longer ones are reported in pieces
constexpr std::size_t searched_back = 65536;  // bytes within which a match lies

}  // namespace

void UartTap::attach(cmsdk::Uart& uart, std::function<std::optional<uint8_t>()> otherwise) {
  uart_ = &uart;
  listening_ = uart.transmitted.listen([this](uint8_t byte) { transmitted(byte); });
  uart.set_source([this, otherwise = std::move(otherwise)]() -> std::optional<uint8_t> {
    if (taken_ == input_.size()) return otherwise();
    const char byte = input_[taken_++];
    if (taken_ == input_.size()) {
      input_.clear();
      taken_ = 0;
    }
    return static_cast<uint8_t>(byte);
  });
}

void UartTap::send(std::string_view bytes) {
  input_.erase(0, std::exchange(taken_, 0));
  input_.append(bytes);
  uart_->look_for_input();
}

std::string UartTap::take(uint64_t& lost) {
  again_.clear();
  if (!output_.repeats()) repeats_ = false;
  return output_.take(lost);
}

void UartTap::search_what_is_sent_again() {
  again_.clear();
  repeats_ = output_.repeats();
}

void UartTap::transmitted(uint8_t byte) {
  const bool is_new = !output_.repeats();
  const char sent = static_cast<char>(byte);
  output_.say({&sent, 1});
  if (repeats_) {
    if (again_.size() == searched_back) again_.erase(0, searched_back / 2);
    again_ += sent;
  }
  const bool ended = byte == '\n';
  if (on_line && is_new) {
    if (!ended && byte != '\r') line_ += sent;
    if (ended || line_.size() == longest_line) on_line(std::exchange(line_, {}));
  }
  if (pattern_ != nullptr && (ended || uart_->transmitter_idle())) search();
}

void UartTap::expect(const re2::RE2* pattern, std::function<void()> on_match) {
  pattern_ = pattern;
  on_match_ = std::move(on_match);
  match_.reset();
  search();
}

void UartTap::search() {
  const std::string& text_to_search = repeats_ ? again_ : output_.said();
  const std::size_t size = text_to_search.size();
  const std::size_t from = size > searched_back ? size - searched_back : 0;
  const re2::StringPiece text(text_to_search.data() + from, size - from);
  std::vector<re2::StringPiece> groups(
      static_cast<std::size_t>(pattern_->NumberOfCapturingGroups()) + 1);
  if (!pattern_->Match(text, 0, text.size(), re2::RE2::UNANCHORED, groups.data(),
                       static_cast<int>(groups.size())))
    return;
  Match match;
  const std::size_t end = static_cast<std::size_t>(groups[0].end() - text_to_search.data());
  for (const re2::StringPiece& group : groups)
    match.groups.push_back(group.data() == nullptr ? std::nullopt
                                                   : std::optional(std::string(group)));
  match.text = text_to_search.substr(0, end);
  if (repeats_) {
    again_.erase(0, end);
    // What is unread of it counts as read: all but what both ends have in common.
    const uint64_t known = output_.known(), matched = output_.sent() - again_.size();
    const uint64_t left = known > matched ? known - matched : 0;
    const std::size_t unread = output_.said().size();
    if (unread > left) output_.pass(unread - static_cast<std::size_t>(left));
    repeats_ = output_.repeats();
  } else {
    output_.pass(end);
  }
  match_ = std::move(match);
  pattern_ = nullptr;
  on_match_();
}

}  // namespace capsoc::service
