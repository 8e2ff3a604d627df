// TCP connections from this machine, received by a separate thread.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "base/result.h"

namespace capsoc::debug {

/// A file descriptor that is closed with its last owner.
class Socket {
 public:
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int get() const { return descriptor_; }
  /// Sends all bytes. False: the peer is gone, or has not read for seconds.
  bool send(std::string_view bytes) const;
  /// Shuts down both directions; the receiving thread sees the end.
  void shut_down() const;

 private:
  int descriptor_;
};

/// An event of a connection since the last call.
struct LineEvent {
  std::shared_ptr<Socket> socket;
  enum class Kind : uint8_t { connected, received, closed } kind;
  std::string bytes = {};
};

/// Listens on 127.0.0.1. Events are queued until next() is called; any() costs one load.
class Connections {
 public:
  /// Port 0 takes a free one.
  static Result<std::unique_ptr<Connections>> listen(uint16_t port);
  ~Connections();
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;

  uint16_t port() const { return port_; }
  bool any() const { return any_.load(std::memory_order_relaxed); }
  bool next(LineEvent& event);
  /// Waits until there are events, at most `longest`.
  void wait(std::chrono::milliseconds longest);

 private:
  Connections(std::shared_ptr<Socket> listener, uint16_t port, int stop_read, int stop_write);
  void receive();
  void post(LineEvent event);

  std::shared_ptr<Socket> listener_, stop_read_, stop_write_;
  uint16_t port_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<LineEvent> events_;
  std::atomic<bool> any_{false};
  std::thread thread_;
};

}  // namespace capsoc::debug
