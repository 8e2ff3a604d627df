// The host's end of a serial line. Nothing here knows of simulated time.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace capsoc::serial {

/// What a wait for the host asks now and then; true ends the wait (a signal, a limit).
using GiveUp = std::function<bool()>;

inline constexpr int patience_ms = 50;      ///< between two questions to give_up
inline constexpr std::size_t piece = 4096;  ///< bytes handed to or taken from the host at once

/// Where the bytes of a UART go to and come from.
class CharacterBackend {
 public:
  virtual ~CharacterBackend() = default;

  /// In order and whole to the client; waits while they are slow. Without a client the bytes are
  /// dropped, as on a line with nothing at its end.
  virtual void write(std::string_view bytes) = 0;
  /// What has arrived, without waiting; empty: nothing at present.
  virtual std::string read() { return {}; }
  /// The host decides when bytes arrive. Otherwise read() depends on nothing but a file.
  virtual bool live() const { return false; }
  /// A client would get what is written now.
  virtual bool has_listener() { return true; }
  /// At the end of the run: returns when everything is delivered, or cannot be.
  virtual void finish() {}
  /// For people: where to connect; empty where that is not needed.
  virtual std::string place() const { return {}; }
  /// Why bytes were lost that should have been kept, a sentence; empty if none were.
  virtual std::string failure() const { return {}; }
};

}  // namespace capsoc::serial
