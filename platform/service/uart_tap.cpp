#include "service/uart_tap.h"

#include <re2/re2.h>

#include <utility>
#include <vector>

namespace capsoc::service {
namespace {

constexpr std::size_t longest_line = 4096;    // longer ones are told in pieces
constexpr std::size_t searched_back = 65536;  // a match lies within so many bytes

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
  lost = std::exchange(lost_, 0);
  again_.clear();
  if (sent_ >= told_) repeats_ = false;
  return std::exchange(output_, {});
}

void UartTap::set_told(Told told) {
  told_ = told.told;
  output_ = std::move(told.unread);
  lost_ = told.lost;
  again_.clear();
  repeats_ = sent_ < told_;
}

void UartTap::keep(uint8_t byte) {
  if (output_.size() == most_kept) {
    output_.erase(0, most_kept / 2);
    lost_ += most_kept / 2;
  }
  output_ += static_cast<char>(byte);
}

void UartTap::transmitted(uint8_t byte) {
  const bool is_new = sent_++ >= told_;
  if (is_new) keep(byte);
  if (repeats_) {
    if (again_.size() == searched_back) again_.erase(0, searched_back / 2);
    again_ += static_cast<char>(byte);
  }
  const bool ended = byte == '\n';
  if (on_line && is_new) {
    if (!ended && byte != '\r') line_ += static_cast<char>(byte);
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
  match(repeats_ ? again_ : output_);
}

void UartTap::match(std::string& text_to_search) {
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
  text_to_search.erase(0, end);
  if (repeats_) {
    // What is unread of it counts as read: all but what both ends have in common.
    const uint64_t known = sent_ > told_ ? sent_ : told_, matched = sent_ - again_.size();
    const uint64_t left = known > matched ? known - matched : 0;
    if (output_.size() > left) output_.erase(0, output_.size() - static_cast<std::size_t>(left));
    repeats_ = sent_ < told_;
  }
  match_ = std::move(match);
  pattern_ = nullptr;
  on_match_();
}

}  // namespace capsoc::service
