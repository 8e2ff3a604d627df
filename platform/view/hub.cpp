#include "view/hub.h"

#include <utility>

namespace capsoc::view {

void Hub::publish(Text update, Text full, bool begins) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (full != nullptr) wants_full_ = false;
    if (frames_.size() == most_frames) frames_.pop_front();
    frames_.push_back({next_frame_++, std::move(update), std::move(full), begins});
  }
  if (wake_) wake_();
}

std::vector<Command> Hub::take_commands() {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_ = 0;
  return std::exchange(commands_, {});
}

void Hub::wait(std::chrono::milliseconds longest) {
  std::unique_lock<std::mutex> lock(mutex_);
  news_.wait_for(lock, longest, [this] { return has_news_; });
  has_news_ = false;
}

std::vector<Frame> Hub::take_frames() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<Frame> taken(frames_.begin(), frames_.end());
  frames_.clear();
  return taken;
}

void Hub::ask_for_full() {
  const std::lock_guard<std::mutex> lock(mutex_);
  wants_full_ = true;
  has_news_ = true;
  news_.notify_one();
}

void Hub::set_viewers(std::size_t count) {
  viewers_ = count;
}

std::optional<uint64_t> Hub::add(Json body) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (commands_.size() == most_commands) return std::nullopt;
  commands_.push_back({next_command_, std::move(body)});
  waiting_ = commands_.size();
  has_news_ = true;
  news_.notify_one();
  return next_command_++;
}

}  // namespace capsoc::view
