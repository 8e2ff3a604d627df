#include "semihosting/console.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

namespace capsoc::semihosting {
namespace {

constexpr std::size_t longest_pending = 4096;
constexpr std::chrono::milliseconds look_again{1};

}  // namespace

void Console::write(std::string_view text) {
  pending_ += text;
  if (pending_.find('\n') != std::string::npos || pending_.size() >= longest_pending) flush();
}

void Console::flush() {
  if (!pending_.empty()) backend_->write(std::exchange(pending_, {}));
}

void Console::finish() {
  flush();
  backend_->finish();
}

bool Console::refill() {
  while (incoming_.empty()) {
    incoming_ = backend_->read();
    if (!incoming_.empty()) return true;
    if (!backend_->live() || give_up_()) return false;
    std::this_thread::sleep_for(look_again);
  }
  return true;
}

/// A line at a time, so that it does not matter how many of them the host has at once.
std::optional<std::string> Console::read(std::size_t most) {
  flush();  // the prompt
  if (!refill()) return backend_->asks() ? std::nullopt : std::optional(std::string());
  const std::size_t line = std::min(incoming_.find('\n'), incoming_.size() - 1) + 1;
  std::string text = incoming_.substr(0, std::min(most, line));
  incoming_.erase(0, text.size());
  return text;
}

}  // namespace capsoc::semihosting
