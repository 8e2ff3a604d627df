// One UART's line from the chip to the host.
#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "host/sha256.h"
#include "serial/character_backend.h"
#include "serial/line_watch.h"

namespace capsoc::serial {

/// Configuration of a line. `input` and `log` are file names; empty: none.
struct LineConfig {
  std::string name;     ///< "uart0"
  std::string backend;  ///< as open_backend() takes it
  std::string input;    ///< bytes come from this file instead of the backend
  std::string log;      ///< gets a copy of what the UART sends
  bool wait = false;    ///< the first byte waits until a client listens
  Patterns patterns;
};

/// Counts, hashes, logs and watches the UART's output, passes it to the backend in pieces, and has
/// the next byte for the receiver.
class SerialLine {
 public:
  static Result<std::unique_ptr<SerialLine>> open(LineConfig config, const GiveUp& give_up);

  /// A byte was transmitted; `dry`: the transmitter is empty after it.
  void transmitted(uint8_t byte, bool dry);
  /// The next byte for the receiver, if there is one now.
  std::optional<uint8_t> next_input();
  /// Called for the first match of the patterns.
  void on_match(std::function<void()> callback) { on_match_ = std::move(callback); }

  /// Passes buffered output to the backend.
  void flush();
  /// Delivers everything, at the end of the run.
  void finish();

  /// Saves or loads the counters and the input position. Host bytes that the UART has not received
  /// yet are not part of the state: a continued run gets input from its backend.
  void visit(Archive& archive);

  const std::string& name() const { return config_.name; }
  const CharacterBackend& backend() const { return *backend_; }
  bool live() const { return backend_->live(); }
  const std::optional<LineWatch::Match>& match() const { return match_; }
  uint64_t bytes() const { return bytes_; }
  std::string sha256() const { return digest_.hex(); }
  /// A sentence for the backend and for the log if bytes were lost that should have been kept.
  std::vector<std::string> failures() const;

 private:
  SerialLine(LineConfig config, std::unique_ptr<CharacterBackend> backend, GiveUp give_up);
  std::optional<Error> open_files();
  void wait_for_listener();
  bool refill();

  LineConfig config_;
  std::unique_ptr<CharacterBackend> backend_;
  GiveUp give_up_;
  LineWatch watch_;
  std::optional<LineWatch::Match> match_;
  std::function<void()> on_match_;
  std::ifstream input_;
  std::unique_ptr<CharacterBackend> log_;  ///< null without
  std::string pending_;                    ///< sent by the UART, not yet handed on
  std::string incoming_;                   ///< from the host, not yet received
  std::size_t taken_ = 0;
  uint64_t received_ = 0;  ///< bytes handed to the UART
  uint64_t bytes_ = 0;
  host::Sha256 digest_;
};

}  // namespace capsoc::serial
