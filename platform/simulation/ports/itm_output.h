// Where the text of the processor's ITM goes: the bytes that the program writes to one stimulus
// port.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "base/archive.h"
#include "base/result.h"
#include "serial/character_backend.h"
#include "serial/kept_stream.h"

namespace capsoc::run {

/// The host's side of a stimulus port.
class ItmOutput {
 public:
  /// `place`: stdout, null, log (a line of the log each, level info) or file:PATH. `kept`: instead
  /// of stdout; null: stdout.
  static Result<std::unique_ptr<ItmOutput>> open(const std::string& place, unsigned port,
                                                 serial::KeptStream* kept,
                                                 const serial::GiveUp& give_up);

  /// False: `place` is null, and the text goes nowhere.
  static bool is_shown(const std::string& place) { return place != "null"; }
  /// A write of `size` bytes, the lowest one first; those to other ports are dropped.
  void put(unsigned port, uint32_t value, unsigned size);
  void visit(Archive& archive) {
    if (backend_) flush();
    archive("line", line_);
  }
  /// Hands on an unfinished line.
  void flush();
  /// At the end of the run.
  void finish();
  /// Why text was lost, a sentence; empty if none was.
  std::string failure() const { return backend_ ? backend_->failure() : ""; }

 private:
  ItmOutput(unsigned port, std::unique_ptr<serial::CharacterBackend> backend)
      : port_(port), backend_(std::move(backend)) {}
  void put_byte(char byte);

  unsigned port_;
  std::unique_ptr<serial::CharacterBackend> backend_;  // null: the log
  std::string line_;                                   // so far
};

}  // namespace capsoc::run
