// The host's end of a group of pins: lines of text, "TIME PIN LEVEL".
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "serial/character_backend.h"

namespace capsoc::serial {

/// A level applied to a pin from outside.
struct PinEvent {
  uint64_t picoseconds = 0;  ///< of simulated time; of a script
  unsigned pin = 0;
  bool level = false;
};

/// Values of PinLine::open()'s `spec`, for messages and help.
constexpr const char* pin_backend_names = "null, file:PATH, pty[:LINK], tcp[:PORT] or script:FILE";

/// Parses a script: a line for each event in the order of time, "0.5 3 1" (seconds, pin, level);
/// empty lines and what is after a # do not count. An Error names the line.
Result<std::vector<PinEvent>> parse_pin_script(const std::string& file, const std::string& text,
                                               unsigned pins);

/// Writes changes of the pins as text, and reads levels to apply, from a client or a script.
class PinLine {
 public:
  /// `spec` as pin_backend_names says, `name` as in its option (--gpio0), `pins` their number.
  static Result<std::unique_ptr<PinLine>> open(const std::string& spec, const std::string& name,
                                               unsigned pins, const GiveUp& give_up);

  /// Sets the pins that are driven (low) from the start.
  void begin(uint32_t driven) { driven_ = driven; }
  /// Levels of those pins that the chip drives, after a change.
  void changed(uint64_t picoseconds, uint32_t levels, uint32_t driven);
  /// Events from the client since the last call. An invalid line gets an answer.
  std::vector<PinEvent> heard();
  const std::vector<PinEvent>& script() const { return script_; }

  bool live() const { return backend_->live(); }
  void flush();
  void finish();
  const std::string& name() const { return name_; }
  std::string place() const { return backend_->place(); }
  std::string failure() const { return backend_->failure(); }

 private:
  PinLine(std::string name, unsigned pins, std::unique_ptr<CharacterBackend> backend)
      : name_(std::move(name)), pins_(pins), backend_(std::move(backend)) {}

  std::string name_;
  unsigned pins_;
  std::unique_ptr<CharacterBackend> backend_;
  std::vector<PinEvent> script_;
  std::string said_, incoming_;
  uint32_t levels_ = 0, driven_ = 0;
};

}  // namespace capsoc::serial
