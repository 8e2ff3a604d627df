#include "run/outcome.h"

#include <fmt/format.h>

#include <csignal>

#include "host/end_signals.h"
#include "run/coprocessor_backend.h"
#include "run/run_settings.h"
#include "trace/wave_file.h"

namespace capsoc::run {
namespace {

std::optional<Error> write_waves(const rtl::Lockstep& lockstep, const std::string& path) {
  auto file = trace::WaveFile::at(path);
  if (!file) return Error{file.error()};
  if (auto error = lockstep.write_waves(file.value().growing())) return error;
  return file.value().finish();
}

}  // namespace

void conclude(const RunSettings& settings, const soc::Soc& soc, const HostPorts& ports,
              const StackMarks& stacks, const Limit& limit, bool out_of_time, RunResult& result) {
  using cortex_m3::EndReason;
  const int status = ports.exit_status();
  const int caught_signal = host::noted_signal();
  const auto say = [&](int code, std::string reason) {
    result.code = code;
    result.reason = std::move(reason);
  };
  if (!result.divergence.empty())
    return say(exit_code::diverged, "the coprocessor's model and RTL differ");
  if (!stacks.overflow().empty())
    return say(exit_code::crashed, "the firmware's stack overflowed: " + stacks.overflow());
  const serial::SerialLine* said = ports.uarts().matched();
  if (said != nullptr && said->match()->failed)
    return say(exit_code::failed, fmt::format("{} printed what --fail-uart names: {}", said->name(),
                                              said->match()->line));
  if (soc.cpu.end_reason() == EndReason::exit) {
    if (settings.semihosting.status() == ExitStatus::process)
      return say(status & 0xFF, fmt::format("the firmware ended with status {}", status));
    if (status == 0) return say(exit_code::pass, "the firmware ended with status 0");
    return say(exit_code::failed, fmt::format("the firmware ended with status {}", status));
  }
  if (soc.cpu.end_reason() == EndReason::lockup)
    return say(exit_code::crashed, "the firmware crashed: lockup");
  if (soc.cpu.end_reason() == EndReason::stuck)
    return say(exit_code::crashed, "the firmware crashed: its fault handler branches to itself");
  if (said != nullptr && soc.cpu.end_reason() == EndReason::none)
    return say(exit_code::pass, fmt::format("{} printed what --until-uart names: {}", said->name(),
                                            said->match()->line));
  if (soc.cpu.end_reason() == EndReason::idle) {
    const std::string idle = fmt::format(
        "the firmware is idle: for {} simulated s only timers woke it, and only to sleep again",
        settings.limits.idle_s.text());
    if (settings.uarts.until.empty()) return say(exit_code::pass, idle);
    return say(exit_code::limit, idle + "; no line matched --until-uart");
  }
  const bool sleeps = soc.cpu.end_reason() == EndReason::none && soc.cpu.core().sleeping();
  if (soc.cpu.end_reason() == EndReason::asleep ||
      (sleeps && caught_signal == 0 && !out_of_time && !limit.expired()))
    return say(exit_code::limit, "the firmware sleeps and nothing is left that could wake it");
  if (soc.cpu.end_reason() == EndReason::debugger && caught_signal == 0 && !out_of_time)
    return say(exit_code::pass, "ended by the debugger");
  if (caught_signal != 0)
    return say(exit_code::signal_base + caught_signal,
               fmt::format("ended by signal {}", caught_signal));
  if (out_of_time)
    return say(exit_code::limit,
               fmt::format("the limit of {:g} s of the host was hit", settings.limits.host_s()));
  if (limit.expired())
    return say(exit_code::limit, fmt::format("the limit of {:g} simulated s was hit",
                                             sc_core::sc_time_stamp().to_seconds()));
  say(exit_code::internal, "the simulation ended without a reason");
}

void take_losses(std::vector<std::string> lost, RunResult& result) {
  result.lost = std::move(lost);
  if (result.lost.empty() || result.code != exit_code::pass) return;
  if (host::noted_signal() == SIGPIPE) {
    result.code = exit_code::signal_base + SIGPIPE;
    result.reason += ", but nobody read all of standard output";
    return;
  }
  result.code = exit_code::lost;
  result.reason += ", but not everything that it wrote could be kept";
}

std::string divergence_of(const RunSettings& settings, const rtl::Lockstep* lockstep,
                          const soc::Soc& soc) {
  if (lockstep == nullptr || !lockstep->difference()) return "";
  const std::string waves = lockstep_waves(settings);
  const auto error = write_waves(*lockstep, waves);
  return lockstep->report(reproducing_command(settings),
                          1e9 / static_cast<double>(soc.clock.frequency_hz())) +
         (error ? error->text + "\n" : fmt::format("waves of both sides: {}\n", waves));
}

void take_verdict(const loader::ElfImage& program, soc::Soc& soc, const metrics::Metrics& metrics,
                  RunResult& result) {
  result.verdict = metrics::read_verdict(
      program,
      [&soc](uint32_t address, void* bytes, uint32_t size) {
        return soc.read_memory(address, bytes, size);
      },
      metrics);
  if (!result.verdict || result.verdict->bound_holds().value_or(true) ||
      result.code != exit_code::pass)
    return;
  result.code = exit_code::failed;
  result.reason =
      fmt::format("the program vouches for {:.3g} deg, but an angle is {:.3g} deg wrong",
                  result.verdict->bound_deg, *result.verdict->largest_error_deg);
}

void take_figures(const soc::Soc& soc, const metrics::Metrics& metrics, const UartLines& uarts,
                  RunResult& result) {
  result.simulated_s = sc_core::sc_time_stamp().to_seconds();
  result.instructions = soc.cpu.core().instructions();
  result.cycles = soc.cpu.core().cycles();
  result.translation = soc.cpu.core().translation();
  result.samples = metrics.samples();
  result.convergence = metrics.convergence();
  result.words = metrics.words();
  result.truth = metrics.truth();
  result.phi_comparable = metrics.phi_comparable();
  result.uart0_bytes = uarts.line(0).bytes();
  result.uart0_sha256 = uarts.line(0).sha256();
}

}  // namespace capsoc::run
