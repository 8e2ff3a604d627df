// What passes between a run and its pages: frames to them, commands from them. The run's thread and
// the server's thread meet here and nowhere else; neither waits for the other.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "service/message.h"

namespace capsoc::view {

using service::Json;
using Text = std::shared_ptr<const std::string>;

/// The data sent to a page at one time, as JSON.
struct Frame {
  uint64_t number = 0;  ///< rises by 1; a gap: frames were dropped before a server took them
  Text update;          ///< what is new since the frame before
  Text full;            ///< everything, for a page that lacks earlier frames; null: not asked for
  bool begins = false;  ///< another run: what pages have is of the one before
};

/// A request of a page, {"do": "pause", ...}.
struct Command {
  uint64_t number = 0;  ///< from 1, in the order in which they came
  Json body;
};

class Hub {
 public:
  static constexpr std::size_t most_commands = 256, most_frames = 8;

  // The run's side.

  /// Never waits. `full`: null unless wants_full().
  void publish(Text update, Text full, bool begins = false);
  bool wants_full() const { return wants_full_; }
  std::size_t viewers() const { return viewers_; }
  std::vector<Command> take_commands();
  bool has_commands() const { return waiting_ > 0; }
  /// Until a command comes, a page opens, or the time is over.
  void wait(std::chrono::milliseconds longest);

  // The server's side.

  /// Called by publish(), in the run's thread. Set before the run begins.
  void on_publish(std::function<void()> wake) { wake_ = std::move(wake); }
  std::vector<Frame> take_frames();
  void ask_for_full();
  void set_viewers(std::size_t count);
  /// The command's number. Nothing: too many wait.
  std::optional<uint64_t> add(Json body);

 private:
  mutable std::mutex mutex_;
  std::condition_variable news_;
  std::deque<Frame> frames_;
  std::vector<Command> commands_;
  std::atomic<std::size_t> waiting_{0}, viewers_{0};
  std::atomic<bool> wants_full_{false};
  bool has_news_ = false;
  uint64_t next_frame_ = 1, next_command_ = 1;
  std::function<void()> wake_;
};

}  // namespace capsoc::view
