#include "run/session.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <sstream>

#include "debug/gdb_server.h"
#include "fit/golden.h"
#include "loader/program_file.h"
#include "loader/vector_table.h"
#include "run/coprocessor_backend.h"
#include "run/fault_report.h"
#include "run/itm_output.h"
#include "run/parameter_file.h"
#include "run/progress.h"
#include "run/sample_record.h"
#include "run/semihosting_port.h"
#include "run/sha256.h"
#include "run/trace_settings.h"
#include "run/uart_lines.h"
#include "sensor/load.h"
#include "soc/soc.h"
#include "tlm/guest_error.h"

namespace capsoc::run {
namespace {

namespace fs = std::filesystem;
namespace cop = registers::coprocessor;

constexpr uint32_t coprocessor_base = 0x4000C000;

std::atomic<int> caught_signal{0};

void on_signal(int number) {
  caught_signal = number;
}

/// The sentence of a path that may not be there: built firmware and traces lie beside the program
/// or one level up.
std::string installed(const std::string& relative) {
  for (const char* up : {"", "../"}) {
    const fs::path path = fs::path(program_folder()) / (up + relative);
    std::error_code ignored;
    if (fs::exists(path, ignored)) return fs::proximate(path, ignored).string();
  }
  return (fs::path(program_folder()) / relative).string();
}

std::optional<Parameters> truth_of(const sensor::Description& d) {
  if (!d.a1 || !d.a2 || !d.b1 || !d.b2 || !d.beta || !d.phi) return std::nullopt;
  return Parameters{*d.a1, *d.a2, *d.b1, *d.b2, *d.beta, *d.phi};
}

/// Parameters from outside need a program that has a place for them.
std::string program_of(const Settings& settings) {
  const bool chosen = settings.source("firmware.elf") != SettingSource::built_in;
  if (settings.text("firmware.parameters").empty() || chosen) return settings.text("firmware.elf");
  return installed("firmware/calibrate.elf");
}

/// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  static constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789=._-/,:@+%";
  if (word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// A command line that gives the same run.
std::string reproducing_command(const Settings& settings) {
  std::string text = "capsoc run";
  for (const Setting& setting : settings.all()) {
    if (setting.source == SettingSource::built_in) continue;
    if (is_place(setting.path)) continue;  // where it goes, not what it is
    text += fmt::format(" -C {}", quoted(setting.path + "=" + setting.value));
  }
  return text;
}

/// What --load named, in its order; later ones overwrite.
std::vector<std::string> places_to_load(const Settings& settings) {
  std::vector<std::string> places;
  std::istringstream list(settings.text("firmware.load"));
  for (std::string place; std::getline(list, place, ',');)
    if (!place.empty()) places.push_back(place);
  return places;
}

/// Where the processor starts.
std::optional<Error> place_vector_table(const Settings& settings, const loader::ElfImage& program,
                                        const std::vector<loader::ElfImage>& further,
                                        soc::Soc& soc) {
  std::vector<const loader::ElfImage*> images = {&program};
  for (const loader::ElfImage& image : further) images.push_back(&image);
  const auto table = loader::find_vector_table(images, settings.text("firmware.vector_table"));
  if (!table) return Error{table.error()};
  soc.cpu.core().set_vector_table(table.value());
  return std::nullopt;
}

/// The GDB server that the settings ask for, or null.
Result<std::unique_ptr<debug::GdbServer>> make_gdb_server(const Settings& settings, soc::Soc& soc,
                                                          std::function<bool()> give_up) {
  const long long port = settings.integer("gdb.port");
  const bool halted = settings.text("gdb.halt") == "true";
  if (port < 0 && halted) return Error{"--halt waits for a debugger; give --gdb PORT, too"};
  if (port < 0) return std::unique_ptr<debug::GdbServer>();
  auto connections = debug::Connections::listen(static_cast<uint16_t>(port));
  if (!connections) return Error{connections.error()};
  fmt::print(stderr, "gdb: listening on 127.0.0.1:{}{}\n", connections.value()->port(),
             halted ? ", waiting for a debugger" : "");
  return std::make_unique<debug::GdbServer>(soc, std::move(connections.value()), halted,
                                            std::move(give_up));
}

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

/// The sensor, the coprocessor's results and the metrics wired together.
class Observation {
 public:
  /// `recording`: the samples are kept as the coprocessor saw them.
  Observation(soc::Soc& soc, sensor::Source& source, Metrics& metrics, Progress& progress,
              bool recording)
      : soc_(soc), source_(source), metrics_(metrics), progress_(progress), recording_(recording) {
    soc.adc.set_source([this](uint64_t k, double t) { return next(k, t); });
    // Its edge comes before the next sample, so the truth is still this sample's.
    soc.coprocessor.set_sample_observer([this](uint64_t, bool latched) {
      if (!latched) return;
      metrics_.accepted(truth_);
      if (recording_) record();
    });
    soc.coprocessor.set_result_observer(
        [this](uint64_t, const coprocessor::Nodes& nodes) { result(nodes); });
    soc.adc.set_observer([this](uint64_t, int32_t u, int32_t v, double turns, bool has_truth) {
      converted_ = {sc_core::sc_time_stamp().to_seconds(), u, v, turns, has_truth};
    });
  }

  const std::vector<RecordedSample>& recorded() const { return recorded_; }

 private:
  void record() {
    if (recorded_.empty()) recording_since_s_ = converted_.time_s;
    recorded_.push_back(converted_);
    recorded_.back().time_s -= recording_since_s_;
  }

  std::optional<peripherals::AdcInput> next(uint64_t k, double t) {
    if (k == 0) {
      source_.rewind();
      metrics_.dropped_all();
    }
    const auto value = source_.sample(k, t);
    if (!value) return std::nullopt;
    truth_ = {k, value->u, value->v, value->angle_turns, value->has_truth};
    return peripherals::AdcInput{value->u, value->v, value->angle_turns, value->has_truth};
  }

  void result(const coprocessor::Nodes& nodes) {
    // The observer runs in the cycle of the result, before the firmware can have changed the mode.
    const uint32_t control = soc_.peek(coprocessor_base + cop::CTRL_offset);
    CoprocessorResult r;
    r.angle = static_cast<uint32_t>(nodes.angle);
    r.angle_valid = (nodes.status & cop::STATUS_VALID_mask) != 0;
    r.demodulating = (control & cop::CTRL_DEMOD_mask) != 0;
    r.words = {static_cast<int32_t>(nodes.a1),    static_cast<int32_t>(nodes.a2),
               static_cast<int32_t>(nodes.b1),    static_cast<int32_t>(nodes.b2),
               static_cast<uint32_t>(nodes.beta), static_cast<uint32_t>(nodes.phi)};
    metrics_.result(r);
    progress_.update(sc_core::sc_time_stamp().to_seconds(), r.words);
  }

  soc::Soc& soc_;
  sensor::Source& source_;
  Metrics& metrics_;
  Progress& progress_;
  SensorTruth truth_;
  bool recording_;
  RecordedSample converted_;  ///< the newest of the front-end
  double recording_since_s_ = 0;
  std::vector<RecordedSample> recorded_;
};

/// Why the simulation is over, as an exit code and a sentence.
void conclude(const Settings& settings, const soc::Soc& soc, int status, const UartLines& uarts,
              const Limit& limit, bool out_of_time, RunResult& result) {
  using cortex_m3::EndReason;
  const auto say = [&](int code, std::string reason) {
    result.code = code;
    result.reason = std::move(reason);
  };
  if (!result.divergence.empty())
    return say(exit_code::diverged, "the coprocessor's model and RTL differ");
  const serial::SerialLine* said = uarts.matched();
  if (said != nullptr && said->match()->failed)
    return say(exit_code::failed, fmt::format("{} printed what --fail-uart names: {}", said->name(),
                                              said->match()->line));
  if (soc.cpu.end_reason() == EndReason::exit) {
    if (settings.text("semihosting.status") == "process")
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
  const bool sleeps = soc.cpu.end_reason() == EndReason::none && soc.cpu.core().sleeping();
  if (soc.cpu.end_reason() == EndReason::asleep ||
      (sleeps && caught_signal == 0 && !out_of_time && !limit.expired()))
    return say(exit_code::limit, "the firmware sleeps and nothing is left that could wake it");
  if (soc.cpu.end_reason() == EndReason::debugger && caught_signal == 0 && !out_of_time)
    return say(exit_code::pass, "ended by the debugger");
  if (caught_signal != 0)
    return say(exit_code::signal_base + caught_signal,
               fmt::format("ended by signal {}", caught_signal.load()));
  if (out_of_time)
    return say(exit_code::limit, fmt::format("the limit of {:g} s of the host was hit",
                                             settings.number("run.timelimit_s")));
  if (limit.expired())
    return say(exit_code::limit, fmt::format("the limit of {:g} simulated s was hit",
                                             sc_core::sc_time_stamp().to_seconds()));
  say(exit_code::internal, "the simulation ended without a reason");
}

}  // namespace

std::string program_folder() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path().string();
}

Settings make_settings() {
  Settings s;
  const auto add = [&](const char* path, SettingKind kind, std::string value, const char* help,
                       std::vector<std::string> choices = {}, double minimum = 0,
                       double maximum = 0) {
    s.add({path, kind, std::move(value), help, std::move(choices), minimum, maximum});
  };
  add("firmware.elf", SettingKind::path, installed("firmware/selfcal.elf"),
      "program for the Cortex-M3");
  add("firmware.load", SettingKind::text, "",
      "further images, FILE@ADDRESS (raw), ELF or Intel HEX, separated by commas");
  add("firmware.vector_table", SettingKind::text, "auto",
      "address of the vector table; auto: 0, or where the program has it");
  add("firmware.parameters", SettingKind::path, "",
      "JSON with parameters to write in the program; empty: none");
  add("sensor.file", SettingKind::path, installed("traces/soc_eq21.toml"),
      "sensor description or recording");
  add("sensor.adc_bits", SettingKind::integer, "0",
      "width of the converter at reset; 0: as the sensor says", {}, 0, 32);
  add("coprocessor.arithmetic", SettingKind::choice, "precise", "paper or precise",
      {"paper", "precise"});
  add_backend_settings(s);
  add_trace_settings(s);
  add("cpu.quantum_ns", SettingKind::number, "1000000", "how far the processor may run ahead, ns",
      {}, 1, 1e9);
  add("cpu.executor", SettingKind::choice, "blocks", "blocks (fast) or stepping; same results",
      {"blocks", "stepping"});
  add("run.simlimit_s", SettingKind::number, "0", "limit of simulated time, s; 0: none", {}, 0,
      1e6);
  add("run.timelimit_s", SettingKind::number, "0", "limit of the host's time, s; 0: none", {}, 0,
      1e6);
  add_uart_settings(s);
  add_semihosting_settings(s);
  add("run.stop_in_fault", SettingKind::flag, "true",
      "a fault handler that branches to itself is a crash, if nothing can interrupt it");
  add("itm.backend", SettingKind::text, "null",
      "where the processor's ITM text goes: stdout, null, log (level info) or file:PATH");
  add("itm.port", SettingKind::integer, "0", "stimulus port of that text", {}, 0, 31);
  add("run.golden", SettingKind::flag, "false", "fit the coprocessor's samples by the CSFN, too");
  add("gdb.port", SettingKind::integer, "-1", "port of the GDB server; 0: a free one, -1: none", {},
      -1, 65535);
  add("gdb.halt", SettingKind::flag, "false", "wait for a debugger before the first instruction");
  add("results.json", SettingKind::path, "", "where the results go; empty: nowhere");
  add("results.record", SettingKind::path, "",
      "where the coprocessor's samples go (CSV); empty: nowhere");
  add("log.level", SettingKind::choice, "warn", "trace, debug, info, warn, error, off",
      {"trace", "debug", "info", "warn", "error", "off"});
  return s;
}

Result<RunResult> run(const Settings& settings) {
  const std::string elf = program_of(settings);
  const std::string sensor_file = settings.text("sensor.file");
  auto image = loader::load_program(elf);
  if (!image) return Error{image.error()};
  const std::string parameter_file = settings.text("firmware.parameters");
  std::optional<ParameterWords> preset;
  if (!parameter_file.empty()) {
    const auto words = read_parameters(parameter_file);
    if (!words) return Error{words.error()};
    preset = words.value();
    if (auto error = write_in_program(image.value(), *preset)) return *error;
  }
  auto source = sensor::load(sensor_file);
  if (!source) return Error{source.error()};
  const sensor::Description& description = source.value()->description();
  const long long adc_bits = settings.integer("sensor.adc_bits") != 0
                                 ? settings.integer("sensor.adc_bits")
                                 : description.adc_bits.value_or(32);
  if (adc_bits < 12)
    return Error{fmt::format("sensor.adc_bits = {} is out of range; give 12 to 32", adc_bits)};

  // SystemC prints notes of its own on stdout, which belongs to the firmware.
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  soc::Config config;
  config.coprocessor.arithmetic = settings.text("coprocessor.arithmetic") == "paper"
                                      ? coprocessor::Arithmetic::paper
                                      : coprocessor::Arithmetic::precise;
  auto backend = make_backend(settings, config.coprocessor);
  if (!backend) return Error{backend.error()};
  config.make_coprocessor = [&] { return std::move(backend.value().device); };
  config.quantum = sc_core::sc_time(settings.number("cpu.quantum_ns"), sc_core::SC_NS);
  config.executor = settings.text("cpu.executor") == "blocks" ? cortex_m3::Executor::blocks
                                                              : cortex_m3::Executor::stepping;
  soc::Soc soc("soc", config);
  soc.adc.fit_converter(static_cast<uint32_t>(adc_bits));
  if (auto error = soc.load(image.value())) return *error;
  std::vector<loader::ElfImage> further_images;
  for (const std::string& place : places_to_load(settings)) {
    auto further = loader::load_at(place);
    if (!further) return Error{further.error()};
    if (auto error = soc.load(further.value())) return *error;
    further_images.push_back(std::move(further.value()));
  }
  if (auto error = place_vector_table(settings, image.value(), further_images, soc)) return *error;
  if (settings.text("run.stop_in_fault") == "true")
    soc.cpu.core().set_stop_in_fault([&soc] { return soc.watchdog_is_off(); });

  const double rate = description.sample_rate_hz.value_or(250);
  const double frequency = std::fabs(description.frequency_hz.value_or(0.05));
  const auto revolution =
      static_cast<uint64_t>(std::llround(frequency > 0 ? rate / frequency : 5000));
  Metrics metrics(truth_of(description), rate, std::min<uint64_t>(revolution, 10'000'000));
  if (preset) metrics.preset(*preset);
  Progress progress(isatty(STDERR_FILENO) != 0);
  const bool golden = settings.text("run.golden") == "true";
  const std::string record_file = settings.text("results.record");
  Observation observation(soc, *source.value(), metrics, progress, golden || !record_file.empty());
  tlm_util::set_guest_error_context([&] {
    return fmt::format("pc {:#010x} {}", soc.cpu.core().reg(15),
                       image.value().symbolise(soc.cpu.core().reg(15)));
  });

  rtl::Lockstep* lockstep = backend.value().lockstep;
  if (lockstep != nullptr) lockstep->on_difference([] { sc_core::sc_stop(); });

  Limit limit("limit", settings.number("run.simlimit_s"));
  const double wall_limit = settings.number("run.timelimit_s");
  const auto start = std::chrono::steady_clock::now();
  const auto wall = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  bool out_of_time = false;
  const auto interrupted = [&] {
    out_of_time = wall_limit > 0 && wall() > wall_limit;
    return out_of_time || caught_signal != 0;
  };
  soc.cpu.set_interrupted(interrupted);
  auto itm = ItmOutput::open(settings.text("itm.backend"),
                             static_cast<unsigned>(settings.integer("itm.port")), interrupted);
  if (!itm) return Error{itm.error()};
  soc.cpu.core().set_stimulus([&itm](unsigned port, uint32_t value, unsigned size) {
    itm.value()->put(port, value, size);
  });
  auto tracer = attach_tracer(settings, soc, image.value(), further_images);
  if (!tracer) return Error{tracer.error()};
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGPIPE, on_signal);  // nobody reads stdout any more; sockets do not raise it
  auto semihosting = SemihostingPort::open(settings, soc, image.value(), elf, interrupted);
  if (!semihosting) return Error{semihosting.error()};
  UartLines uarts("uart_lines", soc, interrupted);
  if (auto error = uarts.open(settings)) return *error;
  // While a debugger holds the processor, what it printed is to be seen.
  auto gdb = make_gdb_server(settings, soc, [&] {
    uarts.flush();
    semihosting.value()->flush();
    return interrupted();
  });
  if (!gdb) return Error{gdb.error()};

  sc_core::sc_start();

  semihosting.value()->flush();
  uarts.finish();
  for (const std::string& failure : uarts.failures()) spdlog::error(failure);
  itm.value()->flush();
  if (const std::string failure = itm.value()->failure(); !failure.empty()) spdlog::error(failure);
  progress.finish();
  tlm_util::summarise_guest_errors();
  tlm_util::set_guest_error_context({});

  if (tracer.value() != nullptr)
    if (auto error = tracer.value()->finish()) return *error;

  RunResult result;
  result.command = reproducing_command(settings);
  if (lockstep != nullptr && lockstep->difference()) {
    const std::string waves = lockstep_waves(settings);
    const auto error = lockstep->write_waves(waves);
    result.divergence =
        lockstep->report(result.command, 1e9 / static_cast<double>(soc.clock.frequency_hz()));
    result.divergence +=
        error ? error->text + "\n" : fmt::format("waves of both sides: {}\n", waves);
  }
  if (backend.value().rtl != nullptr && lockstep == nullptr) backend.value().rtl->close_waves();
  conclude(settings, soc, semihosting.value()->exit_status(), uarts, limit, out_of_time, result);
  if (gdb.value() != nullptr) gdb.value()->finish(result.code);
  result.simulated_s = sc_core::sc_time_stamp().to_seconds();
  result.wall_s = wall();
  result.instructions = soc.cpu.core().instructions();
  result.cycles = soc.cpu.core().cycles();
  result.samples = metrics.samples();
  result.convergence_s = metrics.convergence_s();
  result.words = metrics.words();
  result.truth = metrics.truth();
  result.errors = metrics.angle_errors();
  result.uart0_bytes = uarts.line(0).bytes();
  result.uart0_sha256 = uarts.line(0).sha256();
  result.inputs = {{"firmware", elf, sha256_of_file(elf)},
                   {"sensor", sensor_file, sha256_of_file(sensor_file)}};
  for (const std::string& place : places_to_load(settings)) {
    const std::string file = place.substr(0, place.rfind('@'));
    result.inputs.push_back({"image", place, sha256_of_file(file)});
  }
  for (unsigned n = 0; n < soc.uarts().size(); ++n)
    if (const std::string& input = settings.text(fmt::format("uart{}.input", n)); !input.empty())
      result.inputs.push_back({fmt::format("uart{}", n), input, sha256_of_file(input)});
  if (preset)
    result.inputs.push_back({"parameters", parameter_file, sha256_of_file(parameter_file)});
  if (golden) result.golden = fit::compare(observation.recorded(), result.words);
  if (!record_file.empty())
    if (auto error = write_whole(
            record_file,
            to_recording(observation.recorded(), "The coprocessor's samples of " + result.command)))
      return *error;
  if (result.code == exit_code::crashed)
    result.fault_report = describe_fault(soc.cpu.core(), image.value());
  return result;
}

}  // namespace capsoc::run
