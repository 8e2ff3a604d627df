// The words of GDB's `monitor`.
#pragma once

#include <cstdint>
#include <string>

namespace capsoc::debug {

/// What a monitor line asks for: a reset or a checkpoint first, then a halt or a start, and a text
/// for the console.
struct MonitorAnswer {
  bool reset = false, halt = false, resume = false;
  uint32_t stimulus_ports = 0;  ///< of the ITM, bit n is port n; 0: they stay as they are
  bool stimulus_on = false;
  std::string save;  ///< the file that the state goes to
  std::string text;
  bool help = false;  ///< the text is the list of commands
};

/// Every line has an answer; what is unknown is said so and does nothing, because an error would
/// end the launch of several IDEs.
MonitorAnswer answer_monitor(const std::string& line);

}  // namespace capsoc::debug
