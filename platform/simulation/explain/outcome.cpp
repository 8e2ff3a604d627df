#include "explain/outcome.h"

#include <fmt/format.h>

#include <csignal>
#include <utility>

#include "host/end_signals.h"
#include "kit/seconds.h"

namespace capsoc::run {
namespace {

using armv7m::EndReason;

/// An exit code with its reason.
struct Verdict {
  int code;
  std::string reason;
};

/// Of SYS_EXIT.
Verdict exited(const End& end) {
  std::string reason = fmt::format("the firmware ended with status {}", end.exit_status);
  if (end.status_is_code) return {end.exit_status & 0xFF, std::move(reason)};
  return {end.exit_status == 0 ? exit_code::pass : exit_code::failed, std::move(reason)};
}

Verdict idled(const End& end) {
  std::string idle = fmt::format(
      "the firmware is idle: for {} simulated s only timers woke it, and only to sleep again",
      end.end_on_idle);
  if (!end.waits_for_line) return {exit_code::pass, std::move(idle)};
  return {exit_code::limit, idle + "; no line matched --until-uart"};
}

/// The host's reasons, and the kernel's.
Verdict stopped(const End& end) {
  if (end.signal != 0)
    return {exit_code::signal_base + end.signal, fmt::format("ended by signal {}", end.signal)};
  if (end.out_of_time)
    return {exit_code::limit,
            fmt::format("the limit of {:g} s of the host was hit", end.host_limit_s)};
  if (end.simlimit_reached)
    return {exit_code::limit, fmt::format("the limit of {:g} simulated s was hit",
                                          kit::to_seconds(sc_core::sc_time_stamp()))};
  if (end.could_go_on)
    return {exit_code::pass,
            fmt::format("closed at {:g} simulated s", kit::to_seconds(sc_core::sc_time_stamp()))};
  return {exit_code::internal, "the simulation ended without a reason"};
}

Verdict verdict_of(const End& end, const soc::Soc& soc) {
  const EndReason reason = soc.cpu.end_reason();
  const bool called = end.signal != 0 || end.out_of_time || end.could_go_on;
  if (end.diverged) return {exit_code::diverged, "the coprocessor's model and RTL differ"};
  if (!end.crash.empty()) return {exit_code::crashed, end.crash};
  if (end.matched != nullptr && end.matched->match()->failed)
    return {exit_code::failed, fmt::format("{} printed what --fail-uart names: {}",
                                           end.matched->name(), end.matched->match()->line)};
  if (!end.missed.empty()) return {exit_code::failed, end.missed};
  if (reason == EndReason::exit) return exited(end);
  if (reason == EndReason::lockup) return {exit_code::crashed, "the firmware crashed: lockup"};
  if (reason == EndReason::stuck)
    return {exit_code::crashed, "the firmware crashed: its fault handler branches to itself"};
  if (end.matched != nullptr && reason == EndReason::none)
    return {exit_code::pass, fmt::format("{} printed what --until-uart names: {}",
                                         end.matched->name(), end.matched->match()->line)};
  if (reason == EndReason::end_on_idle) return idled(end);
  const bool sleeps =
      reason == EndReason::asleep || (reason == EndReason::none && soc.cpu.core().sleeping());
  if (sleeps && !called && !end.simlimit_reached)
    return {exit_code::limit, "the firmware sleeps and nothing is left that could wake it"};
  if (reason == EndReason::debugger && !called) return {exit_code::pass, "ended by the debugger"};
  return stopped(end);
}

}  // namespace

void conclude(const End& end, const soc::Soc& soc, RunResult& result) {
  Verdict verdict = verdict_of(end, soc);
  // Only where the run could not continue: a user who stopped it did not want the rest of the
  // script.
  if (!end.unfinished.empty() && !end.could_go_on &&
      (verdict.code == exit_code::pass || verdict.code == exit_code::limit)) {
    if (verdict.code == exit_code::pass) verdict.code = exit_code::failed;
    verdict.reason += "; " + end.unfinished;
  }
  result.code = verdict.code;
  result.reason = std::move(verdict.reason);
}

void take_losses(RunResult& result) {
  if (result.lost.empty() || result.code != exit_code::pass) return;
  if (host::noted_signal() == SIGPIPE) {
    result.code = exit_code::signal_base + SIGPIPE;
    result.reason += ", but standard output was not read to its end";
    return;
  }
  result.code = exit_code::lost;
  result.reason += ", but not everything that it wrote could be kept";
}

}  // namespace capsoc::run
