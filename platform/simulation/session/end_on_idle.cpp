#include "session/end_on_idle.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "capsoc_registers.h"

namespace capsoc::run {
namespace {

/// Memories and timers are no work: an idle program has its tick, and feeds its watchdog.
bool is_quiet(const bus::MapEntry& entry) {
  static const std::vector<std::string> timers = {"timer0", "timer1", "dual_timer", "watchdog"};
  if (entry.kind == bus::TargetKind::memory) return true;
  for (const std::string& timer : timers)
    if (entry.target == timer) return true;
  return false;
}

}  // namespace

void end_on_idle(double seconds, soc::Soc& soc) {
  if (seconds <= 0) return;
  std::vector<std::pair<uint64_t, uint64_t>> quiet;  // first and last address
  for (const bus::MapEntry& entry : soc.ahb.map())
    if (is_quiet(entry)) quiet.emplace_back(entry.base, entry.last());
  const auto is_access = [quiet](uint32_t address) {
    for (const auto& [first, last] : quiet)
      if (address >= first && address <= last) return false;
    return true;
  };
  // Between the processor's accesses only the ADC front-end works by itself: its samples are the
  // coprocessor's.
  const auto is_running = [&soc] {
    return soc.adc.status.any(registers::adc::STATUS_RUNNING_mask);
  };
  const auto steps = [&soc] { return uint64_t{soc.adc.count.get()}; };
  constexpr double shortest = 1e-6;  // less than a waking takes
  soc.cpu.set_end_on_idle(
      armv7m::EndOnIdle(sc_core::sc_time(std::max(seconds, shortest), sc_core::SC_SEC),
                        {is_access, is_running, steps}));
}

}  // namespace capsoc::run
