// Where in the program the lines came from that the UARTs print.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "explain/program_view.h"
#include "kit/probe.h"
#include "observers/run_observer.h"
#include "ports/uart_lines.h"
#include "soc/soc.h"

namespace capsoc::run {

/// Keeps the call stacks of the newest lines: a byte is on the wire for a while after the program
/// wrote it, and the program continues meanwhile.
class PrintedLines final : public RunObserver {
 public:
  /// `uarts`: whose line may have ended the run.
  PrintedLines(const ProgramView& view, const UartLines& uarts) : view_(view), lines_(uarts) {}

  std::optional<Error> open() override;
  /// Who printed the line for which --fail-uart ended the run.
  void finish(RunResult& result) override;

 private:
  struct Line {
    uint64_t number = 0;  ///< of the byte that ended it
    source::CallStack stack;
  };
  struct Uart {
    uint64_t written = 0, sent = 0;
    std::deque<Line> lines;
    armv7m::InterruptedRegisters newest;  ///< at the newest byte
    kit::Listening transmitted;
  };
  void written(const tlm::tlm_generic_payload& payload);
  /// Of the newest line that a UART has sent to its end, or of what came after it: the call stack
  /// of its last byte, as lines of a report; "" if none was kept.
  std::string call_stack(std::size_t uart) const;

  const ProgramView& view_;
  const UartLines& lines_;
  std::array<Uart, soc::Soc::uart_count> uarts_;
  std::array<uint32_t, soc::Soc::uart_count> addresses_{};
  kit::Listening transfers_;
};

}  // namespace capsoc::run
