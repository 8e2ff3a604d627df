// Why a simulation is over, as an exit code and a sentence.
#pragma once

#include <string>

#include "results/results.h"
#include "serial/serial_line.h"
#include "soc/soc.h"

namespace capsoc::run {

/// What is known when the simulation is over, in addition to the state of the processor.
struct End {
  bool diverged = false;                        ///< model and RTL of the coprocessor
  std::string crash;                            ///< by which an observer stopped it, "" if none did
  const serial::SerialLine* matched = nullptr;  ///< whose line --until-uart or --fail-uart names
  std::string missed;             ///< what a UART's script expected and did not hear, "" without
  std::string unfinished;         ///< of a UART's script, "" without
  bool waits_for_line = false;    ///< --until-uart was given
  int exit_status = 0;            ///< of the firmware's SYS_EXIT
  bool status_is_code = false;    ///< its low byte is the exit code
  std::string end_on_idle;        ///< run.end_on_idle as it was given, s
  int signal = 0;                 ///< that ended it; 0: none
  double host_limit_s = 0;        ///< limit of the host's time
  bool out_of_time = false;       ///< it was reached
  bool simlimit_reached = false;  ///< the limit of simulated time was reached
  bool could_go_on = false;       ///< the caller that advanced it stopped
};

/// Sets code and reason of the result.
void conclude(const End& end, const soc::Soc& soc, RunResult& result);

/// Makes exit code `lost`, or that of SIGPIPE, of a pass with outputs that are not whole.
void take_losses(RunResult& result);

}  // namespace capsoc::run
