// What a run that is over has to say.
#pragma once

#include <string>
#include <vector>

#include "metrics/metrics.h"
#include "rtl/lockstep.h"
#include "run/host_ports.h"
#include "run/results.h"
#include "run/run_limits.h"
#include "run/stack_marks.h"
#include "soc/soc.h"

namespace capsoc::run {

class RunSettings;

/// The report of lockstep's difference, "" if there is none; its waves are written.
std::string divergence_of(const RunSettings& settings, const rtl::Lockstep* lockstep,
                          const soc::Soc& soc);

/// Why the simulation is over, as an exit code and a sentence; the divergence is in the result.
void conclude(const RunSettings& settings, const soc::Soc& soc, const HostPorts& ports,
              const StackMarks& stacks, const Limit& limit, bool out_of_time, RunResult& result);

/// A pass whose bound the truth does not keep is none.
void take_verdict(const loader::ElfImage& program, soc::Soc& soc, const metrics::Metrics& metrics,
                  RunResult& result);

/// What could not be written is told of by the run's exit code if nothing worse has happened.
void take_losses(std::vector<std::string> lost, RunResult& result);

void take_figures(const soc::Soc& soc, const metrics::Metrics& metrics, const UartLines& uarts,
                  RunResult& result);

}  // namespace capsoc::run
