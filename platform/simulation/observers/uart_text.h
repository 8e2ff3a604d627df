// What UART 0 printed, for a report.
#pragma once

#include <cstdint>
#include <string>

#include "base/archive.h"
#include "cmsdk/uart.h"
#include "kit/probe.h"

namespace capsoc::run {

/// Keeps the beginning and the end of what a UART sends.
class UartText {
 public:
  void listen(cmsdk::Uart& uart);

  /// What was sent until now.
  void visit(Archive& archive);

  std::string text() const;
  /// Bytes between the beginning and the end.
  uint64_t left_out() const;

 private:
  static constexpr std::size_t part = 32 * 1024;

  std::string begin_, end_;  ///< the end is a ring
  std::size_t next_ = 0;     ///< the oldest byte of the ring
  uint64_t bytes_ = 0;
  kit::Listening listening_;
};

}  // namespace capsoc::run
