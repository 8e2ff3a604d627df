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
    "itm port N on   enable stimulus port N of the ITM, as a printf viewer does; off, ports "
    "on|off\n"
    "save FILE        save the whole state, for capsoc run --restore FILE\n"
    "help             this text\n"
    "Words of OpenOCD, pyOCD, J-Link and QEMU that need nothing here are taken silently.\n";

/// First words that probes' servers know and that ask for nothing a simulator would have to do.
constexpr std::array<const char*, 27> needless = {
    "arm",         "adapter", "adapter_khz",   "tpiu",     "rtt",         "swo",
    "semihosting", "clrbp",   "speed",         "flash",    "endian",      "device",
    "interface",   "exec",    "gdb_sync",      "gdb_port", "poll",        "cortex_m",
    "cortex_m3",   "target",  "targets",       "tcl_port", "telnet_port", "threads",
    "set",         "info",    "gdb_memory_map"};

/// OpenOCD's `itm port N on|off|1|0` and `itm ports on|off|1|0`.
void answer_itm(const std::vector<std::string>& words, MonitorAnswer& answer) {
  constexpr uint32_t all_ports = 0xFFFFFFFF;
  const bool all = words.size() == 3 && words[1] == "ports";
  const bool one = words.size() == 4 && words[1] == "port" && words[2].size() <= 2 &&
                   words[2].find_first_not_of("0123456789") == std::string::npos &&
                   std::stoul(words[2]) < 32;
  const std::string& state = words.back();
  const bool on = state == "on" || state == "1";
  if ((!all && !one) || (!on && state != "off" && state != "0")) {
    answer.text = "itm: write itm port N on|off, N below 32, or itm ports on|off\n";
    return;
  }
  answer.stimulus_ports = all ? all_ports : 1U << std::stoul(words[2]);
  answer.stimulus_on = on;
}

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
  } else if (first == "itm") {
    answer_itm(words, answer);
  } else if (first == "help" || first == "?") {
    answer.text = help;
    answer.help = true;
  } else {
    for (const char* word : needless)
      if (first == word) return answer;
    answer.text = fmt::format("'{}' is not known here and does nothing; try `monitor help`\n",
                              line.substr(0, 80));
  }
  return answer;
}

}  // namespace capsoc::debug
