// Common part of the pseudo-terminal and socket backends: a client connects, may be slow, and
// leaves.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>

#include "serial/character_backend.h"

namespace capsoc::serial {

class StreamBackend : public CharacterBackend {
 public:
  explicit StreamBackend(GiveUp give_up) : give_up_(std::move(give_up)) {}

  void write(std::string_view bytes) override;
  std::string read() override;
  bool live() const override { return true; }
  bool has_listener() override { return client() >= 0; }

 protected:
  /// The descriptor of the connected client, -1 without one. Never blocks.
  virtual int client() = 0;
  /// Where bytes that a client sent before it left can still be read.
  virtual int source() { return client(); }
  /// Writes some bytes without blocking; as write(2).
  virtual ssize_t put(int descriptor, std::string_view bytes) = 0;
  /// Reads some bytes without blocking; as read(2).
  virtual ssize_t get(int descriptor, std::string& bytes) = 0;
  /// The client is gone, or its output has ended.
  virtual void lost() {}
  virtual void input_ended() {}

  bool gives_up() const { return give_up_ && give_up_(); }

 private:
  void wait_for_room(int descriptor);
  std::string receive(int descriptor);

  GiveUp give_up_;
  std::string ahead_;  ///< arrived while a write waited
};

}  // namespace capsoc::serial
