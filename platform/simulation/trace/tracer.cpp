#include "trace/tracer.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "armv7m/active_exception.h"
#include "base/ends_with.h"
#include "host/files.h"
#include "kit/seconds.h"
#include "trace/picoseconds.h"
#include "trace/profile.h"
#include "trace/save_file.h"

namespace capsoc::trace {
Result<std::unique_ptr<Tracer>> Tracer::attach(soc::Soc& soc, const TraceOptions& options,
                                               const std::vector<const loader::ElfImage*>& images,
                                               LineOf line_of) {
  std::unique_ptr<Tracer> tracer(new Tracer(soc, options));
  tracer->line_of_ = std::move(line_of);
  for (const loader::ElfImage* image : images) tracer->functions_.add(*image);
  if (!images.empty())
    tracer->program_ = std::filesystem::path(images.front()->path).filename().string();
  const auto start = Bound::parse(options.start, "trace.start", tracer->functions_);
  if (!start) return Error{start.error()};
  const auto stop = Bound::parse(options.stop, "trace.stop", tracer->functions_);
  if (!stop) return Error{stop.error()};
  tracer->window_.emplace(start.value(), stop.value());
  if (auto error = tracer->open()) return *error;
  tracer->connect();
  return tracer;
}

std::optional<Error> Tracer::open() {
  if (!options_.instructions.empty()) {
    auto file = LineFile::open(options_.instructions, options_.depth);
    if (!file) return Error{file.error()};
    instructions_ = std::make_unique<InstructionTrace>(std::move(file.value()), functions_);
  }
  if (!options_.bus.empty()) {
    auto file = LineFile::open(options_.bus, options_.depth);
    if (!file) return Error{file.error()};
    bus_ = std::make_unique<BusTrace>(std::move(file.value()), soc::board_peripherals(soc_));
  }
  if (!options_.profile.empty()) {
    if (auto error = host::check_writable(options_.profile)) return error;
    calls_ = std::make_unique<CallTree>(functions_);
    calls_->count(window_->open());
  }
  if (!options_.waves.empty()) {
    const std::string save = save_file(options_.waves);
    if (save == options_.waves)
      return Error{options_.waves + ": GTKWave's save file has this name; call the waves .fst"};
    for (const std::string& place : {options_.waves, save})
      if (auto error = host::check_writable(place)) return error;
    auto file = FstFile::create(options_.waves);
    if (!file) return Error{file.error()};
    waves_ = std::make_unique<Waves>(std::move(file.value()), options_.waves, soc_);
    waves_->open(window_->open(), 0);
  }
  if (!options_.timeline.empty()) {
    auto timeline = Timeline::create(options_.timeline, soc_, functions_);
    if (!timeline) return Error{timeline.error()};
    timeline_ = std::move(timeline.value());
    timeline_->open(window_->open(), 0);
    soc_.cpu.core().listeners().sleeps = [this](bool is_asleep) { timeline_->sleeps(is_asleep); };
  }
  if (!options_.translation.empty() || options_.perf_map) {
    auto trace = TranslationTrace::open(options_.translation, options_.perf_map, functions_);
    if (!trace) return Error{trace.error()};
    translation_ = std::move(trace.value());
  }
  return std::nullopt;
}

void Tracer::connect() {
  const bool stepping = instructions_ != nullptr || calls_ != nullptr || window_->has_addresses() ||
                        (bus_ != nullptr && options_.fetches);
  if (translation_ != nullptr)
    soc_.cpu.core().listeners().translated = [this](const armv7m::Translation& translation) {
      translation_->put(translation);
    };
  soc_.cpu.core().add_observer(*this, stepping, bus_ != nullptr);
  if (bus_ != nullptr || waves_ != nullptr || timeline_ != nullptr)
    transfers_ = soc_.ahb.transfers.listen(
        [this](const tlm::tlm_generic_payload& payload, const sc_core::sc_time& begin,
               const sc_core::sc_time& end) { transfer(payload, begin, end); });
  if (waves_ != nullptr)
    results_ = soc_.coprocessor.results.listen(
        [this](uint64_t, const coprocessor::Nodes& nodes, uint64_t) { result(nodes); });
}

Tracer::~Tracer() {
  soc_.cpu.core().listeners().translated = nullptr;
  soc_.cpu.core().listeners().sleeps = nullptr;
  soc_.cpu.core().remove_observer(*this);
}

void Tracer::begin() {
  const armv7m::Core& core = soc_.cpu.core();
  const uint64_t now = picoseconds_of(core.cycles());
  open_at(now);
  if (calls_ != nullptr) calls_->begin(core);
  if (waves_ != nullptr) waves_->begin(now, armv7m::active_exception(core));
  if (timeline_ != nullptr) timeline_->begin(core);
}

uint64_t Tracer::picoseconds_of(uint64_t cycle) const {
  return picoseconds(soc_.clock.time_of(cycle));
}

double Tracer::seconds_of(uint64_t cycle) const {
  return kit::to_seconds(soc_.clock.time_of(cycle));
}

/// After a change of the window.
void Tracer::follow_window(uint64_t picoseconds) {
  if (calls_ != nullptr) calls_->count(window_->open());
  if (waves_ != nullptr) waves_->open(window_->open(), picoseconds);
  if (timeline_ != nullptr) timeline_->open(window_->open(), picoseconds);
}

bool Tracer::open_at(uint64_t picoseconds) {
  if (window_->has_times()) {
    window_->time(picoseconds);
    follow_window(picoseconds);
  }
  return window_->open();
}

void Tracer::issued(const armv7m::Core& core, const armv7m::DecodedOp& op) {
  if (window_->has_times()) open_at(picoseconds_of(core.cycles()));
  if (window_->has_addresses()) {
    window_->instruction(op.address);
    follow_window(picoseconds_of(core.cycles()));
  }
  if (calls_ != nullptr) calls_->issued(core);
  if (instructions_ != nullptr && window_->open()) instructions_->issued(core, op);
  if (bus_ == nullptr || !options_.fetches || !window_->open()) return;
  BusAccess fetch;
  fetch.cycle = core.cycles();
  fetch.seconds = seconds_of(fetch.cycle);
  fetch.initiator = op.address < 0x20000000 ? "i-code" : "system";
  fetch.address = op.address;
  fetch.size = op.size;
  // In memory the first halfword comes first.
  fetch.data = op.size == 4 ? op.encoding >> 16U | op.encoding << 16U : op.encoding;
  bus_->put(fetch);
}

void Tracer::retired(const armv7m::Core& core, const armv7m::DecodedOp& op) {
  if (calls_ != nullptr) calls_->retired(core, op);
  if (instructions_ != nullptr && instructions_->pending())
    instructions_->retired(core, op, seconds_of(instructions_->issue_cycle()));
}

void Tracer::entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how,
                     uint64_t since) {
  const bool open = open_at(picoseconds_of(core.cycles()));
  if (calls_ != nullptr) calls_->entered(core, exception, how, since);
  if (instructions_ != nullptr && open)
    instructions_->entered(exception, how, since, seconds_of(since));
  if (waves_ != nullptr) waves_->exception(picoseconds_of(core.cycles()), exception);
  if (timeline_ != nullptr) timeline_->entered(core, exception, how, since);
}

void Tracer::returned(const armv7m::Core& core, unsigned exception) {
  const bool open = open_at(picoseconds_of(core.cycles()));
  if (calls_ != nullptr) calls_->returned(core, exception);
  if (instructions_ != nullptr && open)
    instructions_->returned(core, exception, seconds_of(core.cycles()));
  if (waves_ != nullptr)
    waves_->exception(picoseconds_of(core.cycles()), armv7m::active_exception(core));
  if (timeline_ != nullptr) timeline_->returned(core);
}

void Tracer::accessed(const armv7m::Core& core, const armv7m::DirectAccess& access) {
  if (bus_ == nullptr || !open_at(picoseconds_of(core.cycles()))) return;
  BusAccess seen;
  seen.cycle = core.cycles();
  seen.seconds = seconds_of(seen.cycle);
  seen.initiator = data_port(access.address);
  seen.address = access.address;
  seen.data = access.value;
  seen.size = access.size;
  seen.write = access.write;
  seen.status = access.ok ? "ok" : "error";
  bus_->put(seen);
}

void Tracer::started(const armv7m::Core& core) {
  const bool open = open_at(picoseconds_of(core.cycles()));
  if (calls_ != nullptr) calls_->started(core);
  if (instructions_ != nullptr && open) instructions_->started(core, seconds_of(core.cycles()));
  if (waves_ != nullptr) waves_->exception(picoseconds_of(core.cycles()), 0);
  if (timeline_ != nullptr) timeline_->started(core);
}

void Tracer::transfer(const tlm::tlm_generic_payload& payload, const sc_core::sc_time& begin,
                      const sc_core::sc_time& end) {
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  if (!open_at(picoseconds(now + begin))) return;
  const auto kind = soc_.cpu.accessing();
  // Fetches are their own lines, one an instruction, unless they fail.
  if (kind == armv7m::AccessKind::fetch && payload.is_response_ok()) return;
  BusAccess seen;
  seen.cycle = soc_.clock.cycles_at(now + begin);
  seen.seconds = kit::to_seconds(now + begin);
  seen.cycles = std::max<uint64_t>(1, soc_.clock.cycles_at(now + end) - seen.cycle + 1);
  seen.address = static_cast<uint32_t>(payload.get_address());
  seen.initiator = !kind                                ? "debugger"
                   : seen.address >= 0x20000000         ? "system"
                   : *kind == armv7m::AccessKind::fetch ? "i-code"
                                                        : "d-code";
  seen.data = data_word(payload);
  seen.size = std::min(payload.get_data_length(), 4U);
  seen.write = payload.is_write();
  seen.status = status_name(payload.get_response_status());
  if (bus_ != nullptr) bus_->put(seen);
  if (waves_ == nullptr && timeline_ == nullptr) return;
  const sc_core::sc_time period =
      soc_.clock.time_of(seen.cycle + 1) - soc_.clock.time_of(seen.cycle);
  const uint64_t begin_ps = picoseconds(now + begin), end_ps = picoseconds(now + end + period);
  if (waves_ != nullptr) waves_->transfer(begin_ps, end_ps, seen);
  if (timeline_ != nullptr) timeline_->transfer(begin_ps, end_ps, seen);
}

void Tracer::result(const coprocessor::Nodes& nodes) {
  const uint64_t now = picoseconds(sc_core::sc_time_stamp());
  open_at(now);
  waves_->result(now, nodes);
}

std::vector<FunctionCost> Tracer::top_functions() {
  constexpr std::size_t most = 40;
  if (calls_ == nullptr) return {};
  return trace::top_functions(*calls_, functions_, most);
}

std::optional<Error> Tracer::finish_timeline(const std::string& end) {
  if (timeline_ == nullptr) return std::nullopt;
  return timeline_->finish(picoseconds(sc_core::sc_time_stamp()), end);
}

std::vector<Error> Tracer::finish() {
  const armv7m::Core& core = soc_.cpu.core();
  std::vector<Error> errors;
  const auto keep = [&errors](std::optional<Error> error) {
    if (error) errors.push_back(std::move(*error));
  };
  if (instructions_ != nullptr) keep(instructions_->finish(core, seconds_of(core.cycles())));
  if (bus_ != nullptr) keep(bus_->finish());
  if (calls_ != nullptr) {
    calls_->finish(core);
    keep(host::write_whole(options_.profile,
                           ends_with(options_.profile, ".folded")
                               ? to_folded(*calls_, functions_)
                               : to_callgrind(*calls_, functions_, program_, line_of_)));
  }
  if (waves_ != nullptr) keep(waves_->finish(picoseconds(sc_core::sc_time_stamp())));
  if (translation_ != nullptr) keep(translation_->finish());
  return errors;
}

}  // namespace capsoc::trace
