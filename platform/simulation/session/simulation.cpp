#include "session/simulation.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "explain/fault_report.h"
#include "explain/outcome.h"
#include "host/end_signals.h"
#include "kit/seconds.h"
#include "observers/sample_recording.h"
#include "session/end_on_idle.h"
#include "session/run_files.h"
#include "session/run_settings.h"

namespace capsoc::run {
namespace {

soc::Config soc_config(const RunSettings& settings, CoprocessorBackend& backend) {
  soc::Config config;
  config.coprocessor = settings.coprocessor.options();
  config.quantum = sc_core::sc_time(settings.cpu.quantum_ns(), sc_core::SC_NS);
  config.processor = settings.cpu.profile();
  config.executor = settings.cpu.executor();
  config.fast_forward = settings.cpu.fast_forward();
  config.monitor = settings.monitor();
  config.memory_waits = settings.memory.waits();
  config.translator.threshold = static_cast<uint8_t>(settings.cpu.translate_after());
  config.translator.buffer_bytes = static_cast<std::size_t>(settings.cpu.code_buffer_kib()) << 10;
  config.make_coprocessor = [&backend] { return std::move(backend.device); };
  return config;
}

/// Settings that the chosen processor has no use for.
std::optional<Error> check_processor(const RunSettings& settings) {
  const armv7m::Profile& chosen = *settings.cpu.profile();
  const auto refuse = [&chosen](const SettingField& field, const std::string& has) {
    return Error{fmt::format("{}: the {} has {}; leave it out", field.name(), chosen.product, has)};
  };
  const bool fixed = chosen.least_priority_bits == chosen.most_priority_bits;
  if (fixed && !settings.cpu.priority_bits.is_built_in())
    return refuse(settings.cpu.priority_bits,
                  fmt::format("{} bits of each priority", chosen.most_priority_bits));
  if (!chosen.has_itm && settings.itm.backend() != "null")
    return refuse(settings.itm.backend, "no ITM");
  return std::nullopt;
}

std::optional<Error> check_channels(const RunSettings& settings, const RunInputs& inputs) {
  const std::size_t sensors = 1 + inputs.further_sensors.size();
  const auto channels = static_cast<std::size_t>(settings.coprocessor.channels());
  if (sensors == 1 || sensors <= channels) return std::nullopt;
  return Error{fmt::format("{}: there are {} sensors and the coprocessor has {} channel{}; set {}",
                           settings.sensor.further.name(), sensors, channels,
                           channels == 1 ? "" : "s", settings.coprocessor.channels.name())};
}

/// What the run continues from; nothing: from reset.
Result<std::optional<checkpoint::Checkpoint>> restored_state(const RunSettings& settings,
                                                             const RunInputs& inputs,
                                                             const std::string& state) {
  if (state.empty()) return checkpoint_to_restore(settings, inputs);
  if (settings.golden())
    return Error{settings.golden.about().path +
                 " needs all samples, and a restored simulation has the later ones; leave it out"};
  auto unpacked = checkpoint::unpack(state, "the snapshot");
  if (!unpacked) return Error{unpacked.error()};
  return std::optional<checkpoint::Checkpoint>(std::move(unpacked.value()));
}

}  // namespace

Result<std::unique_ptr<Simulation>> Simulation::construct(const RunSettings& settings) {
  return construct(settings, {});
}

Result<std::unique_ptr<Simulation>> Simulation::construct(const RunSettings& settings,
                                                          const Additions& additions) {
  if (auto error = check_processor(settings)) return *error;
  if (auto error = check_recording(settings.results)) return *error;
  auto inputs = read_inputs(settings);
  if (!inputs) return Error{inputs.error()};
  if (auto error = check_channels(settings, inputs.value())) return *error;
  if (additions.inputs) additions.inputs(inputs.value());
  std::optional<checkpoint::Checkpoint> restore;
  if (!additions.waits) {
    auto state = restored_state(settings, inputs.value(), additions.state);
    if (!state) return Error{state.error()};
    restore = std::move(state.value());
  }
  // SystemC prints its own notes on stdout, which belongs to the firmware.
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  // A signal pauses the kernel wherever it is, and where nothing is left to happen is seen to here.
  sc_core::sc_report_handler::set_actions("no activity or clock movement for sc_start() invocation",
                                          sc_core::SC_DO_NOTHING);
  auto backend = make_backend(settings.coprocessor);
  if (!backend) return Error{backend.error()};
  std::unique_ptr<Simulation> simulation(
      new Simulation(settings, std::move(inputs.value()), std::move(restore),
                     std::move(backend.value()), additions.kept));
  if (auto error = simulation->load()) return *error;
  if (auto error = simulation->open(additions.waits)) return *error;
  if (auto error = simulation->plan_restore(true)) return *error;
  return simulation;
}

std::optional<Error> Simulation::set_state(const std::string& state) {
  auto restore = restored_state(settings_, inputs_, state);
  if (!restore) return Error{restore.error()};
  restore_ = std::move(restore.value());
  return std::nullopt;
}

std::optional<Error> Simulation::begin() {
  host_limit_.begin_again();
  if (auto error = watch_host()) return error;
  // Faults have to know the number of samples before they begin.
  return plan_restore(injector_ != nullptr);
}

Simulation::Simulation(const RunSettings& settings, RunInputs inputs,
                       std::optional<checkpoint::Checkpoint> restore, CoprocessorBackend backend,
                       serial::KeptStreams* kept)
    : settings_(settings),
      inputs_(std::move(inputs)),
      restore_(std::move(restore)),
      backend_(std::move(backend)),
      kept_(kept),
      soc_("soc", soc_config(settings, backend_)),
      view_(soc_, inputs_.images()),
      limit_("limit", settings.limits.simulated_s()),
      host_limit_(settings.limits.host_s()),
      real_time_(settings.limits.realtime()),
      watch_(settings, inputs_, soc_, view_, backend_) {}

/// The board as it is fitted, its program, and the observers of both.
std::optional<Error> Simulation::load() {
  soc_.cpu.core().set_priority_bits(static_cast<unsigned>(settings_.cpu.priority_bits()));
  if (auto error = watch_.observe_board()) return error;
  soc_.adc.fit_converter(inputs_.adc_bits);
  const auto untranslated = [](const std::string& reason) {
    spdlog::info("cpu.executor: blocks instead of the translator: {}", reason);
  };
  if (const std::string& reason = soc_.cpu.core().no_translator(); !reason.empty())
    untranslated(reason);
  soc_.cpu.core().listeners().untranslated = untranslated;
  end_on_idle(settings_.limits.end_on_idle(), soc_);
  if (auto error = inputs_.load(settings_.firmware, soc_)) return error;
  if (settings_.stop_in_fault())
    soc_.cpu.core().listeners().hopeless = [this] { return soc_.watchdog_is_off(); };
  return std::nullopt;
}

std::optional<Error> Simulation::watch_host() {
  host::note_end_signals();
  return host_limit_.watch([this] { call_from_signal(); });
}

/// What belongs to the host.
std::optional<Error> Simulation::open(bool waits) {
  soc_.cpu.set_interrupted([this] {
    if (real_time_.on()) pace();
    host_limit_.answered();
    return interrupted();
  });
  // Before anything is opened that a signal should close again. A fork has no timer of its parent.
  if (!waits)
    if (auto error = watch_host()) return error;
  if (auto error = watch_.observe_program()) return error;
  auto ports = HostPorts::open(
      {settings_.uarts, settings_.pins, settings_.semihosting, settings_.itm, settings_.gdb, kept_},
      soc_, inputs_.program, inputs_.program_file, [this] { return interrupted(); });
  if (!ports) return Error{ports.error()};
  ports_ = std::move(ports.value());
  if (real_time_.on()) ports_->pace_by([this] { pace(); });
  if (auto error = watch_.observe_outputs(ports_->uarts())) return error;
  checkpoints_ = std::make_unique<Checkpoints>(settings_, inputs_, soc_, parts(), gathered());
  if (auto error = checkpoints_->plan()) return error;
  if (auto error = plan_faults()) return error;
  soc_.cpu.set_pause(next_pause(), [this](const sc_core::sc_time& now) { return pause(now); });
  ports_->on_save(
      [this](const std::string& file) { return checkpoints_->save_beside(file, "monitor save"); });
  return std::nullopt;
}

std::optional<Error> Simulation::plan_faults() {
  auto injector =
      inject::Injector::make(settings_.inject, soc_, backend_, view_.program().images());
  if (!injector) return Error{injector.error()};
  injector_ = std::move(injector.value());
  return std::nullopt;
}

std::optional<Error> Simulation::inject(inject::Fault fault) {
  if (injector_ == nullptr) {
    injector_ = std::make_unique<inject::Injector>(soc_);
    injector_->restored();
  }
  const inject::Places places(soc_, backend_, view_.program().images());
  const uint64_t sample = watch_.observation().sample_number();
  if (auto error = injector_->add(std::move(fault), places, sample)) return error;
  injector_->pause(sc_core::sc_time_stamp());
  soc_.cpu.pause_soon();
  return std::nullopt;
}

std::vector<FaultOutcome> Simulation::injected() const {
  std::vector<FaultOutcome> all = past_faults_;
  if (injector_ == nullptr) return all;
  const std::vector<FaultOutcome> present = injector_->added();
  all.insert(all.end(), present.begin(), present.end());
  return all;
}

std::vector<inject::ListedPlace> Simulation::fault_places() {
  return inject::Places(soc_, backend_, view_.program().images()).all();
}

sc_core::sc_time Simulation::next_pause() const {
  const sc_core::sc_time next = checkpoints_->next();
  return injector_ == nullptr ? next : std::min(next, injector_->next());
}

/// Everything that has a state.
std::vector<checkpoint::Part> Simulation::parts() {
  std::vector<checkpoint::Part> parts = parts_of(soc_);
  parts.push_back({"observation", [this](Archive& archive) { watch_.all().visit(archive); }});
  parts.push_back({"host", [this](Archive& archive) {
                     ports_->visit(archive);
                     if (injector_ != nullptr) injector_->visit(archive);
                   }});
  return parts;
}

/// What only states in memory have.
std::vector<checkpoint::Part> Simulation::gathered() {
  std::vector<checkpoint::Part> parts = gathered_parts(watch_.all());
  parts.push_back(gathered_part("faults", [this](Archive& archive) {
    std::vector<FaultOutcome> all = injected();
    archive("outcomes", all);
    if (archive.loading() && archive.ok()) past_faults_ = std::move(all);
  }));
  return parts;
}

/// Tried before anything is begun; then again, when its time has come.
std::optional<Error> Simulation::plan_restore(bool is_tried) {
  if (!restore_) return std::nullopt;
  if (is_tried)
    if (auto error = checkpoints_->load(*restore_)) return error;
  const auto time = sc_core::sc_time::from_value(restore_->time);
  const bool is_snapshot = settings_.checkpoint.restore.empty();
  if (injector_ != nullptr)
    if (auto error = injector_->begin_from(time, watch_.observation().sample_number(), is_snapshot))
      return error;
  soc_.cpu.resume_at(time, [this] { return restore(); });
  return std::nullopt;
}

bool Simulation::restore() {
  not_restored_ = checkpoints_->load(*restore_);
  if (not_restored_) return false;
  checkpoints_->restored();
  ports_->restored();
  watch_.all().restored();
  if (injector_ != nullptr) injector_->restored();
  return true;
}

void Simulation::pace() {
  if (!soc_.cpu.waits_for_resume())
    real_time_.pace(sc_core::sc_time_stamp(), [this] { return host_limit_.reached(); });
}

void Simulation::stop_soon() {
  stop_at_ = sc_core::SC_ZERO_TIME;
  soc_.cpu.pause_soon();
}

void Simulation::interrupt() {
  stop_asked_ = true;
  call_from_signal();
}

bool Simulation::take_interruption() {
  stop_asked_ = false;
  return std::exchange(interruption_, false);
}

bool Simulation::is_over() const {
  return sc_core::sc_get_status() == sc_core::SC_STOPPED;
}

bool Simulation::interrupted() {
  if (stop_asked_.exchange(false)) {
    interruption_ = true;
    stop_soon();
  }
  if (checkpoints_ != nullptr) checkpoints_->look_for_signal();
  if (!host_limit_.reached()) return false;
  // A call of the program that gave up waiting for the host is its last one.
  soc_.cpu.core().attention();
  return true;
}

/// The processor stands between two instructions: out of its process, until the next advance.
sc_core::sc_time Simulation::pause(const sc_core::sc_time& now) {
  sc_core::sc_time next = checkpoints_->pause(now);
  if (injector_ != nullptr) next = std::min(next, injector_->pause(now));
  while (stop_at_ <= now) {
    stopped_ = true;
    sc_core::sc_pause();
    sc_core::wait(sc_core::SC_ZERO_TIME);
  }
  return std::min(next, stop_at_);
}

/// In a signal handler. The kernel's pause is a flag that it looks at after every delta cycle.
void Simulation::call_from_signal() {
  called_ = true;
  soc_.cpu.interrupt();
  sc_core::sc_pause();
}

/// Until nothing is left to happen, or the kernel is stopped or paused. A signal's pause is none:
/// it wakes a processor that sleeps while only devices have events.
void Simulation::simulate() {
  for (;;) {
    if (real_time_.on())
      simulate_slice();
    else
      sc_core::sc_start();
    if (stopped_ || sc_core::sc_get_status() != sc_core::SC_PAUSED) return;
    if (called_.exchange(false))
      soc_.cpu.wake_if_interrupted();
    else if (!real_time_.on() || !sc_core::sc_pending_activity())
      return;
  }
}

/// Paced time is held while only devices have events, too.
void Simulation::simulate_slice() {
  pace();
  const bool begun = sc_core::sc_get_status() == sc_core::SC_PAUSED;
  const sc_core::sc_time slice = real_time_.slice();
  const sc_core::sc_time left = sc_core::sc_max_time() - sc_core::sc_time_stamp();
  const sc_core::sc_time next =
      begun ? sc_core::sc_time_to_pending_activity() : sc_core::SC_ZERO_TIME;
  sc_core::sc_start(slice < left && next < left - slice ? next + slice : left,
                    sc_core::SC_EXIT_ON_STARVATION);
}

Result<bool> Simulation::advance_to(const sc_core::sc_time& time) {
  if (sc_core::sc_get_status() == sc_core::SC_STOPPED) return false;
  if (time <= sc_core::sc_time_stamp() && stopped_) return true;
  stop_at_ = time;
  stopped_ = false;
  // Before the first instruction the processor does not know yet.
  if (time != sc_core::sc_max_time()) soc_.cpu.pause_now();
  simulate();
  if (not_restored_) return *not_restored_;
  return stopped_;
}

std::optional<Error> Simulation::advance_to_end() {
  if (const auto more = advance_to(sc_core::sc_max_time()); !more) return Error{more.error()};
  return std::nullopt;
}

std::optional<Error> Simulation::save(const std::string& file) {
  if (!stopped_)
    return Error{file +
                 ": not saved: the run is over, or has not begun; save between two advances"};
  return checkpoints_->save_beside(file, "save");
}

Result<std::string> Simulation::packed_state(bool with_gathered) {
  if (!stopped_) return Error{"the run is over: it has no state to resume from"};
  return checkpoints_->packed(with_gathered);
}

std::optional<uint64_t> Simulation::state_hash() {
  StateHash hash;
  hash.set_time(sc_core::sc_time_stamp().value());
  for (const checkpoint::Part& part : parts_of(soc_)) part.visit(hash);
  if (!hash.ok()) return std::nullopt;
  return hash.value();
}

void Simulation::conclude_run(RunResult& result) const {
  End end;
  end.diverged = !result.divergence.empty();
  end.crash = watch_.all().crash();
  end.matched = ports_->uarts().matched();
  end.missed = ports_->uarts().missed();
  end.unfinished = ports_->uarts().unfinished();
  end.waits_for_line = !settings_.uarts.until.empty();
  end.exit_status = ports_->exit_status();
  end.status_is_code = settings_.semihosting.status() == ExitStatus::process;
  end.end_on_idle = settings_.limits.end_on_idle.text();
  end.signal = host::noted_signal();
  end.host_limit_s = settings_.limits.host_s();
  end.out_of_time = host_limit_.out_of_time();
  end.simlimit_reached = limit_.expired();
  end.could_go_on = stopped_;
  conclude(end, soc_, result);
}

void Simulation::take_figures(RunResult& result) const {
  const armv7m::Core& core = soc_.cpu.core();
  result.simulated_s = kit::to_seconds(sc_core::sc_time_stamp());
  result.instructions = core.instructions();
  result.cycles = core.cycles();
  result.translation = core.translation();
  result.uart0_bytes = ports_->uarts().line(0).bytes();
  result.uart0_sha256 = ports_->uarts().line(0).sha256();
  result.inputs = input_files(settings_, inputs_);
  for (const loader::ProgramSetting& setting : inputs_.program_settings.all())
    result.program_settings.push_back({setting.name, inputs_.program_settings.value(setting)});
}

/// Where the program is, or what its fault was.
void Simulation::explain(RunResult& result) const {
  if (!watch_.all().crash().empty() || result.code == exit_code::limit)
    result.place_report = describe_place(view_, watch_.all().findings());
  else if (result.code == exit_code::crashed)
    result.fault_report = describe_fault(view_, watch_.all().findings());
}

RunResult Simulation::finish() {
  host_limit_.stop_watching();
  soc_.cpu.count_sleep();
  RunResult result;
  result.command = reproducing_command(settings_);
  pace();  // a sleep that the end of the run cut short
  if (real_time_.lost_s() > 0)
    spdlog::warn("realtime: the host was too slow, or stopped, for {:.3g} s in all",
                 real_time_.lost_s());
  result.lost = ports_->finish();
  for (std::string& sentence : checkpoints_->failures()) result.lost.push_back(std::move(sentence));
  watch_.all().close(result);
  conclude_run(result);
  result.wall_s = host_limit_.elapsed_s();
  watch_.all().finish(result);
  if (injector_ != nullptr) injector_->finish(result);
  result.faults.insert(result.faults.end() - (injector_ ? injector_->added().size() : 0),
                       past_faults_.begin(), past_faults_.end());
  take_losses(result);
  ports_->tell_debugger(result.code);
  take_figures(result);
  explain(result);
  return result;
}

Result<RunResult> run(const RunSettings& settings) {
  auto simulation = Simulation::construct(settings);
  if (!simulation) return Error{simulation.error()};
  if (auto error = simulation.value()->advance_to_end()) return *error;
  return simulation.value()->finish();
}

}  // namespace capsoc::run
