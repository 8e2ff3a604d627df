#include "run/simulation.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <utility>

#include "host/end_signals.h"
#include "kit/guest_error.h"
#include "metrics/begin_recording.h"
#include "run/attached_traces.h"
#include "run/fault_report.h"
#include "run/golden_check.h"
#include "run/idle.h"
#include "run/outcome.h"
#include "run/run_settings.h"

namespace capsoc::run {
namespace {

soc::Config soc_config(const RunSettings& settings, CoprocessorBackend& backend) {
  soc::Config config;
  config.coprocessor = settings.coprocessor.options();
  config.quantum = sc_core::sc_time(settings.cpu.quantum_ns(), sc_core::SC_NS);
  config.executor = settings.cpu.executor();
  config.fast_forward = settings.cpu.fast_forward();
  config.memory_waits = settings.memory.waits();
  config.translator.threshold = static_cast<uint8_t>(settings.cpu.translate_after());
  config.translator.buffer_bytes = static_cast<std::size_t>(settings.cpu.code_buffer_kib()) << 10;
  config.make_coprocessor = [&backend] { return std::move(backend.device); };
  return config;
}

}  // namespace

Result<std::unique_ptr<Simulation>> Simulation::construct(const RunSettings& settings) {
  auto columns = metrics::record_columns(settings.results.record_columns(), "--record-columns");
  if (!columns) return Error{columns.error()};
  if (settings.results.record().empty() && !settings.results.record_columns.empty())
    return Error{"--record-columns: there is no recording; give --record FILE.csv, too"};
  auto inputs = read_inputs(settings);
  if (!inputs) return Error{inputs.error()};
  auto restore = checkpoint_to_restore(settings, inputs.value());
  if (!restore) return Error{restore.error()};
  // SystemC prints notes of its own on stdout, which belongs to the firmware.
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  auto backend = make_backend(settings, settings.coprocessor.options());
  if (!backend) return Error{backend.error()};
  std::unique_ptr<Simulation> simulation(
      new Simulation(settings, std::move(inputs.value()), std::move(restore.value()),
                     std::move(backend.value()), std::move(columns.value())));
  if (auto error = simulation->load()) return *error;
  if (auto error = simulation->open()) return *error;
  if (auto error = simulation->plan_restore()) return *error;
  return simulation;
}

Simulation::Simulation(const RunSettings& settings, RunInputs inputs,
                       std::optional<checkpoint::Checkpoint> restore, CoprocessorBackend backend,
                       metrics::RecordColumns columns)
    : settings_(settings),
      inputs_(std::move(inputs)),
      columns_(std::move(columns)),
      restore_(std::move(restore)),
      backend_(std::move(backend)),
      soc_("soc", soc_config(settings, backend_)),
      view_(soc_, inputs_),
      metrics_(inputs_.make_metrics()),
      match_(inputs_.sensor_file, inputs_.source->description(), inputs_.recorded_speed,
             [this](const std::string& sentence) {
               spdlog::warn("{}", sentence);
               result_.sensor_warnings.push_back(sentence);
             }),
      progress_(isatty(STDERR_FILENO) != 0),
      observation_(soc_, *inputs_.source, metrics_, match_, progress_),
      priorities_(soc_, view_, static_cast<unsigned>(settings.cpu.priority_bits())),
      limit_("limit", settings.limits.simulated_s()),
      host_limit_(settings.limits.host_s()),
      real_time_(settings.limits.realtime()) {
  for (const std::string& sentence : inputs_.sensor_warnings) {
    spdlog::warn("{}", sentence);
    result_.sensor_warnings.push_back(sentence);
  }
}

Simulation::~Simulation() {
  kit::set_guest_error_context({});
}

/// The program, and who is told of what it does.
std::optional<Error> Simulation::load() {
  soc_.adc.fit_converter(inputs_.adc_bits);
  const auto untranslated = [](const std::string& reason) {
    spdlog::info("cpu.executor: blocks instead of the translator: {}", reason);
  };
  if (const std::string& reason = soc_.cpu.core().no_translator(); !reason.empty())
    untranslated(reason);
  soc_.cpu.core().listeners().untranslated = untranslated;
  watch_for_idle(settings_.limits.idle_s(), soc_);
  if (auto error = inputs_.load(settings_, soc_)) return error;
  if (settings_.stop_in_fault())
    soc_.cpu.core().listeners().hopeless = [this] { return soc_.watchdog_is_off(); };
  if (backend_.lockstep != nullptr) backend_.lockstep->on_difference([] { sc_core::sc_stop(); });
  kit::set_guest_error_context([this] { return view_.here(); });
  return std::nullopt;
}

/// What belongs to the host.
std::optional<Error> Simulation::open() {
  soc_.cpu.set_interrupted([this] {
    if (real_time_.on()) pace();
    host_limit_.answered();
    return interrupted();
  });
  // Before anything is opened that a signal should close again.
  host::note_end_signals();
  if (auto error = host_limit_.watch([this] { call_from_signal(); })) return error;
  auto tracer = attach_tracer(settings_, view_);
  if (!tracer) return Error{tracer.error()};
  tracer_ = std::move(tracer.value());
  auto coverage = attach_coverage(settings_, view_);
  if (!coverage) return Error{coverage.error()};
  coverage_ = std::move(coverage.value());
  if (auto error = stacks_.begin(settings_.stacks)) return error;
  if (auto error = schedule_.begin(settings_.schedule)) return error;
  auto ports = HostPorts::open(settings_, soc_, inputs_.program, inputs_.program_file,
                               [this] { return interrupted(); });
  if (!ports) return Error{ports.error()};
  ports_ = std::move(ports.value());
  if (real_time_.on()) ports_->pace_by([this] { pace(); });
  if (!settings_.uarts.fail.empty()) printed_lines_.begin();
  if (settings_.golden())
    keeping_ = observation_.samples.listen(
        [this](const metrics::RecordedSample& sample) { record_.push_back(sample); });
  if (auto error = begin_recording()) return error;
  if (settings_.results.wants_curves()) {
    drawing_ = observation_.samples.listen(
        [this](const metrics::RecordedSample& sample) { curves_.add(sample); });
    uart0_text_.listen(*soc_.uarts()[0]);
  }
  checkpoints_ = std::make_unique<Checkpoints>(settings_, inputs_, soc_, parts());
  if (auto error = checkpoints_->plan()) return error;
  soc_.cpu.set_pause(checkpoints_->next(),
                     [this](const sc_core::sc_time& now) { return pause(now); });
  ports_->on_save(
      [this](const std::string& file) { return checkpoints_->save_beside(file, "monitor save"); });
  return std::nullopt;
}

std::optional<Error> Simulation::begin_recording() {
  const std::string& file = settings_.results.record();
  if (file.empty()) return std::nullopt;
  auto writer = metrics::begin_recording(
      {file, "The coprocessor's samples of " + reproducing_command(settings_), columns_});
  if (!writer) return Error{writer.error()};
  recording_ = std::move(writer.value());
  recorded_ = observation_.samples.listen(
      [this](const metrics::RecordedSample& sample) { recording_->add(sample); });
  return std::nullopt;
}

/// Everything that has a state.
std::vector<checkpoint::Part> Simulation::parts() {
  std::vector<checkpoint::Part> parts = parts_of(soc_);
  parts.push_back({"observation", [this](kit::Archive& archive) {
                     archive("metrics", metrics_);
                     archive("on_the_way", observation_);
                     archive("sensor_match", match_);
                     archive("sensor_warnings", result_.sensor_warnings);
                     archive("priorities", priorities_);
                     archive("vectors", vectors_);
                   }});
  parts.push_back({"host", [this](kit::Archive& archive) { ports_->visit(archive); }});
  return parts;
}

/// Tried before anything is begun; then once more, when its time has come.
std::optional<Error> Simulation::plan_restore() {
  if (!restore_) return std::nullopt;
  if (auto error = checkpoints_->load(*restore_)) return error;
  soc_.cpu.resume_at(sc_core::sc_time::from_value(restore_->time), [this] { return restore(); });
  return std::nullopt;
}

bool Simulation::restore() {
  not_restored_ = checkpoints_->load(*restore_);
  if (not_restored_) return false;
  checkpoints_->restored();
  ports_->restored();
  return true;
}

void Simulation::pace() {
  if (!soc_.cpu.waits_for_resume())
    real_time_.pace(sc_core::sc_time_stamp(), [this] { return host_limit_.reached(); });
}

bool Simulation::interrupted() {
  if (checkpoints_ != nullptr) checkpoints_->look_for_signal();
  if (!host_limit_.reached()) return false;
  // A call of the program that gave up waiting for the host is its last one.
  soc_.cpu.core().attention();
  return true;
}

/// The processor stands between two instructions: out of its process, as long as nobody advances.
sc_core::sc_time Simulation::pause(const sc_core::sc_time& now) {
  const sc_core::sc_time next = checkpoints_->pause(now);
  while (stop_at_ <= now) {
    stopped_ = true;
    sc_core::sc_pause();
    sc_core::wait(sc_core::SC_ZERO_TIME);
  }
  return std::min(next, stop_at_);
}

/// In a signal handler. The kernel's pause is a flag that it looks at behind every delta cycle.
void Simulation::call_from_signal() {
  called_ = true;
  soc_.cpu.interrupt();
  sc_core::sc_pause();
}

/// Until nothing is left to happen, or somebody stops or pauses the kernel. A signal's pause is
/// none: it wakes a processor that sleeps while only devices have events.
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

/// A sentence for each place that lost something.
std::vector<std::string> Simulation::close() {
  std::vector<std::string> lost = ports_->finish();
  const auto keep = [&lost](const std::optional<Error>& error) {
    if (error) lost.push_back(error->text);
  };
  for (std::string& sentence : checkpoints_->failures()) lost.push_back(std::move(sentence));
  progress_.finish();
  match_.finish();
  if (auto sentence = metrics::own_zero(inputs_.sensor_file, inputs_.alignment)) {
    spdlog::warn("{}", *sentence);
    result_.sensor_warnings.push_back(std::move(*sentence));
  }
  observation_.finish();
  kit::summarise_guest_errors();
  kit::set_guest_error_context({});
  if (tracer_ != nullptr)
    for (const Error& error : tracer_->finish()) keep(error);
  if (coverage_ != nullptr) keep(coverage_->finish());
  warn_of_missing_lines(settings_, view_);
  result_.divergence = divergence_of(settings_, backend_.lockstep, soc_);
  if (backend_.rtl != nullptr && backend_.lockstep == nullptr) backend_.rtl->close_waves();
  if (backend_.waves) keep(backend_.waves->finish());
  if (recording_ != nullptr) keep(recording_->finish());
  return lost;
}

RunResult Simulation::finish() {
  host_limit_.stop_watching();
  soc_.cpu.count_sleep();
  result_.command = reproducing_command(settings_);
  pace();  // a sleep that the end of the run cut short
  if (real_time_.lost_s() > 0)
    spdlog::warn("realtime: the host was too slow, or stopped, for {:.3g} s in all",
                 real_time_.lost_s());
  std::vector<std::string> lost = close();
  conclude(settings_, soc_, *ports_, stacks_, limit_, host_limit_.out_of_time(), result_);
  result_.errors = metrics_.angle_errors();
  take_verdict(inputs_.program, soc_, metrics_, result_);
  priorities_.finish(result_.code == exit_code::pass);
  result_.wall_s = host_limit_.elapsed_s();
  if (settings_.golden()) take_golden(soc_, record_, metrics_.words(), result_);
  take_losses(std::move(lost), result_);
  ports_->tell_debugger(result_.code);
  take_figures(soc_, metrics_, ports_->uarts(), result_);
  schedule_.finish(result_);
  if (settings_.results.wants_curves())
    result_.report =
        ReportData{curves_.curves(result_.words), uart0_text_.text(), uart0_text_.left_out()};
  if (tracer_ != nullptr) result_.profile = tracer_->top_functions();
  for (const StackMark& mark : stacks_.marks())
    result_.stacks.push_back({stacks_.name_of(mark), mark.top, mark.lowest});
  result_.inputs = inputs_.files(settings_);
  for (const loader::ProgramSetting& setting : inputs_.program_settings.all())
    result_.program_settings.push_back({setting.name, inputs_.program_settings.value(setting)});
  const Findings findings{vectors_.text(), stacks_.text()};
  if (!stacks_.overflow().empty() || result_.code == exit_code::limit)
    result_.place_report = describe_place(view_, findings);
  else if (result_.code == exit_code::crashed)
    result_.fault_report = describe_fault(view_, findings);
  else if (const auto uart = ports_->uarts().failed())
    result_.place_report =
        describe_line(ports_->uarts().line(*uart), view_, printed_lines_.call_stack(*uart));
  return std::move(result_);
}

Result<RunResult> run(const RunSettings& settings) {
  auto simulation = Simulation::construct(settings);
  if (!simulation) return Error{simulation.error()};
  if (auto error = simulation.value()->advance_to_end()) return *error;
  return simulation.value()->finish();
}

}  // namespace capsoc::run
