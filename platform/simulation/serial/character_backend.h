// The host's end of a serial line. Independent of simulated time.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace capsoc::serial {

/// Polled while waiting for the host; true ends the wait (a signal, a limit).
using GiveUp = std::function<bool()>;

inline constexpr int patience_ms = 50;      ///< between two questions to give_up
inline constexpr std::size_t piece = 4096;  ///< bytes handed to or taken from the host at once

/// Where the bytes of a UART go to and come from.
class CharacterBackend {
 public:
  virtual ~CharacterBackend() = default;

  /// Writes all bytes in order; waits for a slow client. Without a client the bytes are dropped, as
  /// on an unconnected line.
  virtual void write(std::string_view bytes) = 0;
  /// Returns received bytes without waiting; empty: none at present.
  virtual std::string read() { return {}; }
  /// True if it has no input now and has asked a client for some: the guest's read is repeated.
  virtual bool asks() { return false; }
  /// True if the host decides when bytes arrive. Otherwise read() depends only on a file.
  virtual bool live() const { return false; }
  /// True if a client would get what is written now.
  virtual bool has_listener() { return true; }
  /// At the end of the run: returns when everything is delivered, or cannot be.
  virtual void finish() {}
  /// Where to connect, for the user; empty if that is not needed.
  virtual std::string place() const { return {}; }
  /// Why bytes were lost that should have been kept, a sentence; empty if none were.
  virtual std::string failure() const { return {}; }
};

}  // namespace capsoc::serial
