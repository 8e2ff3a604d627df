#include "debug/monitor.h"

#include <fmt/format.h>

#include <array>
#include <sstream>
#include <vector>

namespace capsoc::debug {
namespace {

constexpr const char* help =
    "reset            reset the SoC and leave it halted\n"
    "reset halt|init  the same\n"
    "reset run        reset the SoC and start it\n"
    "halt, stop       halt the processor\n"
    "resume, go       start the processor without waiting for a stop\n"
    "save FILE        save the whole state, for capsoc run --restore FILE\n"
    "help             this text\n"
    "Words of OpenOCD, pyOCD, J-Link and QEMU that need nothing here are taken silently.\n";

/// First words that probes' servers know and that ask for nothing a simulator would have to do.
constexpr std::array<const char*, 28> needless = {
    "arm",         "adapter",  "adapter_khz", "tpiu",    "itm",      "rtt",       "swo",
    "semihosting", "clrbp",    "speed",       "flash",   "endian",   "device",    "interface",
    "exec",        "gdb_sync", "gdb_port",    "poll",    "cortex_m", "cortex_m3", "target",
    "targets",     "tcl_port", "telnet_port", "threads", "set",      "info",      "gdb_memory_map"};

}  // namespace

MonitorAnswer answer_monitor(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  MonitorAnswer answer;
  if (words.empty()) return answer;
  const std::string& first = words[0];
  const std::string second = words.size() > 1 ? words[1] : "";
  if (first == "reset" || first == "system_reset" || first == "jtag_reset") {
    answer.reset = true;
    answer.resume = second == "run";
    answer.halt = !answer.resume;
  } else if (first == "halt" || first == "stop") {
    answer.halt = true;
  } else if (first == "resume" || first == "go" || first == "cont") {
    answer.resume = true;
  } else if (first == "save") {
    if (words.size() == 2)
      answer.save = second;
    else
      answer.text = "save: give one file, without blanks in its name\n";
  } else if (first == "help" || first == "?") {
    answer.text = help;
  } else {
    for (const char* word : needless)
      if (first == word) return answer;
    answer.text = fmt::format("'{}' is not known here and does nothing; try `monitor help`\n",
                              line.substr(0, 80));
  }
  return answer;
}

}  // namespace capsoc::debug
