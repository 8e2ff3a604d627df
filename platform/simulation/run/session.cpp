#include "run/session.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

#include "host/end_signals.h"
#include "host/files.h"
#include "kit/guest_error.h"
#include "run/checkpoints.h"
#include "run/coprocessor_backend.h"
#include "run/fault_report.h"
#include "run/golden_check.h"
#include "run/host_ports.h"
#include "run/idle.h"
#include "run/observation.h"
#include "run/priority_report.h"
#include "run/progress.h"
#include "run/run_inputs.h"
#include "run/run_settings.h"
#include "run/trace_settings.h"
#include "soc/soc.h"

namespace capsoc::run {
namespace {

/// The host's reasons to end a run: a signal, or its own time.
class HostLimit {
 public:
  /// 0 seconds: no limit.
  explicit HostLimit(double seconds) : seconds_(seconds) {}
  double elapsed_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  bool reached() {
    out_of_time_ = seconds_ > 0 && elapsed_s() > seconds_;
    return out_of_time_ || host::noted_signal() != 0;
  }
  /// As it was when it was last asked.
  bool out_of_time() const { return out_of_time_; }

 private:
  double seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool out_of_time_ = false;
};

/// Ends the simulation at a simulated time, whatever the processor does.
class Limit : public sc_core::sc_module {
 public:
  Limit(const sc_core::sc_module_name& name, double seconds) : sc_module(name) {
    SC_HAS_PROCESS(Limit);
    if (seconds <= 0) return;
    SC_METHOD(expire);
    dont_initialize();
    sensitive << event_;
    event_.notify(sc_core::sc_time(seconds, sc_core::SC_SEC));
  }
  bool expired() const { return expired_; }

 private:
  void expire() {
    expired_ = true;
    sc_core::sc_stop();
  }
  sc_core::sc_event event_;
  bool expired_ = false;
};

/// Why the simulation is over, as an exit code and a sentence.
void conclude(const RunSettings& settings, const soc::Soc& soc, const HostPorts& ports,
              const Limit& limit, bool out_of_time, RunResult& result) {
  using cortex_m3::EndReason;
  const int status = ports.exit_status();
  const int caught_signal = host::noted_signal();
  const auto say = [&](int code, std::string reason) {
    result.code = code;
    result.reason = std::move(reason);
  };
  if (!result.divergence.empty())
    return say(exit_code::diverged, "the coprocessor's model and RTL differ");
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

soc::Config soc_config(const RunSettings& settings) {
  soc::Config config;
  config.coprocessor = settings.coprocessor.options();
  config.quantum = sc_core::sc_time(settings.cpu.quantum_ns(), sc_core::SC_NS);
  config.executor = settings.cpu.executor();
  return config;
}

std::optional<Error> write_waves(const rtl::Lockstep& lockstep, const std::string& path) {
  auto file = trace::WaveFile::at(path);
  if (!file) return Error{file.error()};
  if (auto error = lockstep.write_waves(file.value().growing())) return error;
  return file.value().finish();
}

/// What could not be written is told of by the run's exit code if nothing worse has happened.
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

/// The report of lockstep's difference, "" if there is none; its waves are written.
std::string divergence_of(const RunSettings& settings, const rtl::Lockstep* lockstep,
                          const soc::Soc& soc) {
  if (lockstep == nullptr || !lockstep->difference()) return "";
  const std::string waves = lockstep_waves(settings);
  const auto error = write_waves(*lockstep, waves);
  return lockstep->report(reproducing_command(settings),
                          1e9 / static_cast<double>(soc.clock.frequency_hz())) +
         (error ? error->text + "\n" : fmt::format("waves of both sides: {}\n", waves));
}

/// A pass whose bound the truth does not keep is none.
void take_verdict(const loader::ElfImage& program, soc::Soc& soc, RunResult& result) {
  result.verdict = metrics::read_verdict(
      program,
      [&soc](uint32_t address, void* bytes, uint32_t size) {
        return soc.read_memory(address, bytes, size);
      },
      result.errors);
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
  result.samples = metrics.samples();
  result.convergence = metrics.convergence();
  result.words = metrics.words();
  result.truth = metrics.truth();
  result.phi_comparable = metrics.phi_comparable();
  result.uart0_bytes = uarts.line(0).bytes();
  result.uart0_sha256 = uarts.line(0).sha256();
}

}  // namespace

Result<RunResult> run(const RunSettings& settings) {
  const std::string record_file = settings.results.record();
  const auto columns =
      metrics::record_columns(settings.results.record_columns(), "--record-columns");
  if (!columns) return Error{columns.error()};
  if (record_file.empty() && !settings.results.record_columns.empty())
    return Error{"--record-columns: there is no recording; give --record FILE.csv, too"};
  auto read = read_inputs(settings);
  if (!read) return Error{read.error()};
  const RunInputs& inputs = read.value();

  auto restore = checkpoint_to_restore(settings, inputs);
  if (!restore) return Error{restore.error()};

  // SystemC prints notes of its own on stdout, which belongs to the firmware.
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  soc::Config config = soc_config(settings);
  auto backend = make_backend(settings, config.coprocessor);
  if (!backend) return Error{backend.error()};
  rtl::Lockstep* lockstep = backend.value().lockstep;
  rtl::CoprocessorRtl* rtl = backend.value().rtl;
  config.make_coprocessor = [&] { return std::move(backend.value().device); };
  soc::Soc soc("soc", config);
  soc.adc.fit_converter(inputs.adc_bits);
  PriorityReport priorities(soc, inputs.program,
                            static_cast<unsigned>(settings.cpu.priority_bits()));
  watch_for_idle(settings.limits.idle_s(), soc);
  if (auto error = inputs.load(settings, soc)) return *error;
  if (settings.stop_in_fault())
    soc.cpu.core().listeners().hopeless = [&soc] { return soc.watchdog_is_off(); };
  if (lockstep != nullptr) lockstep->on_difference([] { sc_core::sc_stop(); });

  metrics::Metrics metrics = inputs.make_metrics();
  Progress progress(isatty(STDERR_FILENO) != 0);
  const bool golden = settings.golden();
  RunResult result;
  metrics::SensorMatch match(inputs.sensor_file, inputs.source->description(),
                             inputs.recorded_speed, [&result](const std::string& sentence) {
                               spdlog::warn("{}", sentence);
                               result.sensor_warnings.push_back(sentence);
                             });
  Observation observation(soc, *inputs.source, metrics, match, progress,
                          golden || !record_file.empty());
  kit::set_guest_error_context([&] {
    const uint32_t pc = soc.cpu.core().reg(15);
    return fmt::format("pc {:#010x} {}", pc, inputs.program.symbolise(pc));
  });

  Limit limit("limit", settings.limits.simulated_s());
  HostLimit host_limit(settings.limits.host_s());
  Checkpoints* watch = nullptr;
  const auto interrupted = [&host_limit, &watch] {
    if (watch != nullptr) watch->look_for_signal();
    return host_limit.reached();
  };
  soc.cpu.set_interrupted(interrupted);
  // Before anything is opened that a signal should close again.
  host::note_end_signals();
  auto tracer = attach_tracer(settings, soc, inputs.program, inputs.further_images);
  if (!tracer) return Error{tracer.error()};
  auto ports = HostPorts::open(settings, soc, inputs.program, inputs.program_file, interrupted);
  if (!ports) return Error{ports.error()};

  std::vector<checkpoint::Part> parts = parts_of(soc);
  parts.push_back({"observation", [&](kit::Archive& archive) {
                     archive("metrics", metrics);
                     archive("on_the_way", observation);
                     archive("sensor_match", match);
                     archive("sensor_warnings", result.sensor_warnings);
                     archive("priorities", priorities);
                   }});
  parts.push_back({"host", [&](kit::Archive& archive) { ports.value()->visit(archive); }});
  Checkpoints checkpoints(settings, inputs, soc, std::move(parts));
  watch = &checkpoints;
  if (auto error = checkpoints.plan()) return *error;
  ports.value()->on_save(
      [&](const std::string& file) { return checkpoints.save_beside(file, "monitor save"); });
  std::optional<Error> not_restored;
  if (restore.value()) {
    // Tried before anything is begun; then once more, when its time has come.
    const checkpoint::Checkpoint& from = *restore.value();
    if (auto error = checkpoints.load(from)) return *error;
    soc.cpu.resume_at(sc_core::sc_time::from_value(from.time), [&] {
      not_restored = checkpoints.load(from);
      if (not_restored) return false;
      checkpoints.restored();
      ports.value()->restored();
      return true;
    });
  }

  sc_core::sc_start();
  if (not_restored) return *not_restored;

  std::vector<std::string> lost = ports.value()->finish();
  const auto keep = [&lost](const std::optional<Error>& error) {
    if (error) lost.push_back(error->text);
  };
  for (std::string& sentence : checkpoints.failures()) lost.push_back(std::move(sentence));
  progress.finish();
  match.finish();
  kit::summarise_guest_errors();
  kit::set_guest_error_context({});
  if (tracer.value() != nullptr)
    for (const Error& error : tracer.value()->finish()) keep(error);

  result.command = reproducing_command(settings);
  result.divergence = divergence_of(settings, lockstep, soc);
  if (rtl != nullptr && lockstep == nullptr) rtl->close_waves();
  if (backend.value().waves) keep(backend.value().waves->finish());
  if (!record_file.empty())
    keep(host::write_whole(
        record_file,
        metrics::to_recording(observation.recorded(),
                              "The coprocessor's samples of " + result.command, columns.value())));
  conclude(settings, soc, *ports.value(), limit, host_limit.out_of_time(), result);
  result.errors = metrics.angle_errors();
  take_verdict(inputs.program, soc, result);
  priorities.finish(result.code == exit_code::pass);
  result.wall_s = host_limit.elapsed_s();
  if (golden) take_golden(soc, observation.recorded(), metrics.words(), result);
  take_losses(std::move(lost), result);
  ports.value()->tell_debugger(result.code);
  take_figures(soc, metrics, ports.value()->uarts(), result);
  result.inputs = inputs.files(settings);
  for (const loader::ProgramSetting& setting : inputs.program_settings.all())
    result.program_settings.push_back({setting.name, inputs.program_settings.value(setting)});
  if (result.code == exit_code::crashed)
    result.fault_report = describe_fault(soc.cpu.core(), inputs.program);
  return result;
}

}  // namespace capsoc::run
