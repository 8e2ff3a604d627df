// Where the text of the processor's ITM goes: the bytes that the program writes to one stimulus
// port.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "support/result.h"

namespace capsoc::run {

/// The host's side of a stimulus port.
class ItmOutput {
 public:
  /// `place`: stdout, null, log (a line of the log each, level info) or file:PATH.
  static Result<std::unique_ptr<ItmOutput>> open(const std::string& place, unsigned port);
  ~ItmOutput();
  ItmOutput(const ItmOutput&) = delete;
  ItmOutput& operator=(const ItmOutput&) = delete;

  /// A write of `size` bytes, the lowest one first; those to other ports are dropped.
  void put(unsigned port, uint32_t value, unsigned size);
  /// Logs an unfinished line, and hands the file's bytes to the host.
  void flush();

 private:
  ItmOutput(unsigned port, std::FILE* stream, bool owned, bool logs)
      : port_(port), stream_(stream), owned_(owned), logs_(logs) {}
  void put_byte(char byte);

  unsigned port_;
  std::FILE* stream_;  // null: none
  bool owned_, logs_;
  std::string line_;  // of the log, so far
};

}  // namespace capsoc::run
