#include "trace/timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "armv7m/active_exception.h"
#include "armv7m/exception_frame.h"
#include "capsoc_registers.h"
#include "coprocessor/sequencer.h"
#include "trace/exception_name.h"
#include "trace/picoseconds.h"

namespace capsoc::trace {
namespace {

namespace cop = registers::coprocessor;

/// The processes of the format, in the order in which they are shown.
enum Process : unsigned { run = 1, processor, interrupts, coprocessor_, uarts, bus_ };
constexpr unsigned handlers_thread = 1, first_thread = 2;
constexpr unsigned waiting_thread = 1, first_stage_thread = 2;

constexpr std::size_t longest_line = 200, most_suspended = 1000;

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

uint64_t picoseconds_now() {
  return picoseconds(sc_core::sc_time_stamp());
}

/// The format counts in microseconds; all digits of a picosecond.
std::string microseconds(uint64_t ps) {
  return fmt::format("{}.{:06}", ps / 1'000'000, ps % 1'000'000);
}

unsigned exception_of(const bus::InterruptWire& wire) {
  return wire.line == bus::nmi_line ? 2U : 16U + static_cast<unsigned>(wire.line);
}

}  // namespace

Result<std::unique_ptr<Timeline>> Timeline::create(const std::string& path, soc::Soc& soc,
                                                   Functions& functions) {
  auto file = host::GrowingStream::open(path);
  if (!file) return Error{file.error()};
  return std::unique_ptr<Timeline>(new Timeline(std::move(file.value()), soc, functions));
}

Timeline::Timeline(host::GrowingStream file, soc::Soc& soc, Functions& functions)
    : file_(std::move(file)),
      soc_(soc),
      functions_(functions),
      targets_(soc::board_peripherals(soc)) {
  file_.write("{\"displayTimeUnit\":\"ns\",\"traceEvents\":[");
  name_tracks();
  connect_interrupts();
  connect_coprocessor();
  connect_uarts();
}

void Timeline::name_tracks() {
  for (const auto& [process, text] : {std::pair(run, "run"),
                                      {processor, "processor"},
                                      {interrupts, "interrupts"},
                                      {coprocessor_, "coprocessor"},
                                      {uarts, "UARTs"},
                                      {bus_, "bus"}}) {
    name(process, text);
    event(
        fmt::format(R"("ph":"M","pid":{0},"name":"process_sort_index","args":{{"sort_index":{0}}})",
                    static_cast<unsigned>(process)));
  }
  name(Track{run, 1}, "end");
  name(Track{processor, handlers_thread}, "handlers");
  name(Track{coprocessor_, waiting_thread}, "taken");
  for (unsigned stage = 0; stage < coprocessor::stage_count; ++stage)
    name(Track{coprocessor_, first_stage_thread + stage}, fmt::format("T{}", stage));
}

void Timeline::connect_interrupts() {
  soc_.each_interrupt(
      [this](kit::InterruptLine& source, const char* device, const bus::InterruptWire& wire) {
        Line added;
        added.track = {interrupts, static_cast<unsigned>(lines_.size()) + 1};
        added.name = fmt::format("{} {}", device, wire.output);
        added.source = &source;
        name(added.track, added.name);
        lines_of_.emplace(exception_of(wire), lines_.size());
        source.connect([this, index = lines_.size()](bool level) { line(index, level); });
        lines_.push_back(std::move(added));
      });
}

void Timeline::connect_coprocessor() {
  listening_.push_back(
      soc_.coprocessor.samples.listen([this](uint64_t, bool is_taken, uint64_t number) {
        if (!is_taken) return;
        taken_.emplace_back(number, picoseconds_now());
        // A reset loses what is in the pipeline.
        if (taken_.size() > 1 + coprocessor::stage_count) taken_.pop_front();
      }));
  listening_.push_back(
      soc_.coprocessor.results.listen([this](uint64_t, const coprocessor::Nodes& nodes,
                                             uint64_t number) { result(nodes, number); }));
}

void Timeline::connect_uarts() {
  std::size_t number = 0;
  for (cmsdk::Uart* const uart : soc_.uarts()) {
    name(Track{uarts, static_cast<unsigned>(number) + 1}, fmt::format("uart{}", number));
    listening_.push_back(
        uart->transmitted.listen([this, number](uint8_t value) { byte(number, value); }));
    ++number;
  }
}

void Timeline::name(unsigned process, const std::string& text) {
  event(fmt::format(R"("ph":"M","pid":{},"name":"process_name","args":{{"name":{}}})", process,
                    quoted(text)));
}

void Timeline::name(Track track, const std::string& text) {
  event(fmt::format(R"("ph":"M","pid":{},"tid":{},"name":"thread_name","args":{{"name":{}}})",
                    track.process, track.thread, quoted(text)));
  event(fmt::format(
      R"("ph":"M","pid":{},"tid":{},"name":"thread_sort_index","args":{{"sort_index":{}}})",
      track.process, track.thread, track.thread));
}

void Timeline::event(const std::string& members) {
  file_.write(is_empty_ ? "\n{" : ",\n{");
  file_.write(members);
  file_.write("}");
  is_empty_ = false;
}

/// `arguments`: the members of "args".
void Timeline::slice(Track track, const std::string& name, uint64_t begin_ps, uint64_t end_ps,
                     const std::string& arguments) {
  if (!open_) return;
  const uint64_t begin = std::max(begin_ps, opened_ps_);
  const std::string duration = microseconds(std::max(end_ps, begin) - begin);
  event(fmt::format(R"("ph":"X","pid":{},"tid":{},"ts":{},"dur":{},"name":{},"args":{{{}}})",
                    track.process, track.thread, microseconds(begin), duration, quoted(name),
                    arguments));
}

void Timeline::counter(const char* name, uint64_t at_ps, const std::string& value) {
  event(fmt::format(R"("ph":"C","pid":{},"ts":{},"name":"{}","args":{{"value":{}}})",
                    static_cast<unsigned>(coprocessor_), microseconds(at_ps), name, value));
}

void Timeline::open(bool on, uint64_t picoseconds) {
  if (on == open_) return;
  if (on) {
    opened_ps_ = picoseconds;
    open_ = true;
    return;
  }
  cut(picoseconds);
  open_ = false;
}

/// What lasts, as far as it got.
void Timeline::cut(uint64_t picoseconds) {
  if (!open_) return;
  for (const Line& line : lines_)
    if (line.is_high) slice(line.track, line.name, line.since_ps, picoseconds);
  for (std::size_t i = 0; i < texts_.size(); ++i) flush(i);
  for (const Handler& handler : handlers_)
    slice({processor, handlers_thread}, handler.name, handler.begin_ps, picoseconds,
          handler.arguments);
  if (asleep_since_ps_)
    end_sleep(picoseconds);
  else if (handlers_.empty())
    rest(picoseconds);
}

uint64_t Timeline::ps(uint64_t cycle) const {
  return picoseconds(soc_.clock.time_of(cycle));
}

void Timeline::started(const armv7m::Core& core) {
  const uint64_t now = ps(core.cycles());
  end_sleep(now);
  while (!handlers_.empty()) end_handler(now);
  rest(now);
  running_.reset();
  suspended_.clear();
  resume(core);
}

void Timeline::begin(const armv7m::Core& core) {
  const uint64_t now = ps(core.cycles());
  opened_ps_ = now;
  for (Line& line : lines_) {
    line.is_high = line.source->level();
    line.since_ps = now;
    line.since_cycle = core.cycles();
  }
  const unsigned exception = armv7m::active_exception(core);
  if (exception == 0)
    resume(core);
  else
    handlers_.push_back({exception_name(exception), "", now});
  if (core.sleeping()) asleep_since_ps_ = now;
}

/// The thread that has the processor loses it.
void Timeline::rest(uint64_t picoseconds) {
  if (running_ && picoseconds > running_since_ps_)
    slice(running_->track, "runs", running_since_ps_, picoseconds);
}

void Timeline::sleeps(bool is_asleep) {
  const uint64_t now = ps(soc_.cpu.core().cycles());
  if (!is_asleep) return end_sleep(now);
  if (handlers_.empty()) rest(now);
  asleep_since_ps_ = now;
}

/// In a handler it is a part of the handler's slice.
void Timeline::end_sleep(uint64_t picoseconds) {
  if (!asleep_since_ps_) return;
  const bool is_thread = handlers_.empty() && running_;
  slice(is_thread ? running_->track : Track{processor, handlers_thread}, "sleeps",
        *asleep_since_ps_, picoseconds);
  asleep_since_ps_.reset();
  running_since_ps_ = picoseconds;
}

void Timeline::entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how,
                       uint64_t since) {
  const uint64_t begin = ps(since);
  if (how != armv7m::Entry::preempts && !handlers_.empty()) {
    end_handler(begin);
  } else if (handlers_.empty()) {
    if (!running_) begin_thread("");  // after --restore
    running_->stack = armv7m::stacked_frame(core);
    rest(begin);
  }
  handlers_.push_back({exception_name(exception), latency(exception, core.cycles()), begin});
}

/// Of the line that rose first and was not served since.
std::string Timeline::latency(unsigned exception, uint64_t cycle) {
  std::optional<uint64_t> risen;
  const auto [first, last] = lines_of_.equal_range(exception);
  for (auto each = first; each != last; ++each) {
    Line& line = lines_[each->second];
    if (std::exchange(line.is_served, true)) continue;
    risen = std::min(risen.value_or(line.since_cycle), line.since_cycle);
  }
  if (!risen) return "";
  return fmt::format(R"("latency_cycles":{})", cycle - std::min(cycle, *risen));
}

void Timeline::end_handler(uint64_t picoseconds) {
  const Handler& handler = handlers_.back();
  slice({processor, handlers_thread}, handler.name, handler.begin_ps, picoseconds,
        handler.arguments);
  handlers_.pop_back();
}

void Timeline::returned(const armv7m::Core& core) {
  if (!handlers_.empty()) end_handler(ps(core.cycles()));
  if (handlers_.empty()) resume(core);
}

/// A thread has the processor: the one that was interrupted with this stack, or another one.
void Timeline::resume(const armv7m::Core& core) {
  running_since_ps_ = ps(core.cycles());
  const auto is_here = [&core](const Thread& thread) {
    return armv7m::is_unstacked(core.reg(13), thread.stack, core.state().has_fp_context());
  };
  if (running_ && is_here(*running_)) return;
  if (running_) suspended_.push_back(*running_);
  const auto found = std::find_if(suspended_.begin(), suspended_.end(), is_here);
  if (found != suspended_.end()) {
    running_ = *found;
    suspended_.erase(found);
    return;
  }
  if (suspended_.size() > most_suspended) suspended_.pop_front();
  begin_thread(functions_[functions_.at(core.reg(15))].name);
}

void Timeline::begin_thread(const std::string& function) {
  running_ = Thread{0, {processor, first_thread + threads_}};
  name(running_->track,
       fmt::format("thread {}{}{}", threads_, function.empty() ? "" : ": ", function));
  ++threads_;
}

void Timeline::line(std::size_t index, bool level) {
  Line& line = lines_[index];
  if (level == line.is_high) return;
  const uint64_t now = picoseconds_now();
  if (level)
    line.is_served = false;
  else
    slice(line.track, line.name, line.since_ps, now);
  line.is_high = level;
  line.since_ps = now;
  line.since_cycle = soc_.clock.cycles_at(sc_core::sc_time_stamp());
}

/// The stages take equal times, one after the other; before them a sample waits for a tick.
void Timeline::result(const coprocessor::Nodes& nodes, uint64_t number) {
  uint64_t taken = 0;
  const auto mine = std::find_if(taken_.begin(), taken_.end(),
                                 [number](const auto& each) { return each.first == number; });
  if (mine != taken_.end()) {
    taken = mine->second;
    taken_.erase(taken_.begin(), mine + 1);
  }
  if (!open_) return;
  const sc_core::sc_time time = sc_core::sc_time_stamp();
  const uint64_t now = picoseconds(time);
  const uint64_t tick = picoseconds(soc_.clock.duration(soc_.coprocessor.device().tick(), time));
  const std::string name = number == 0 ? "written" : fmt::format("sample {}", number);
  const uint64_t begin = now - std::min(now, coprocessor::stage_count * tick);
  if (mine != taken_.end() && taken < begin)
    slice({coprocessor_, waiting_thread}, name, taken, begin);
  const auto status = static_cast<uint32_t>(nodes.status);
  const double degrees = static_cast<uint32_t>(nodes.angle) * (360 / 4294967296.0);
  const bool is_valid = (status & cop::STATUS_VALID_mask) != 0;
  for (unsigned stage = 0; stage < coprocessor::stage_count; ++stage) {
    const bool is_last = stage + 1 == coprocessor::stage_count;
    slice({coprocessor_, first_stage_thread + stage}, name, begin + stage * tick,
          begin + (stage + 1) * tick,
          is_last ? fmt::format(R"("angle_deg":{:.9f},"valid":{},"lock":{},"alarm":{})", degrees,
                                is_valid, (status & cop::STATUS_LOCK_mask) != 0,
                                (status & cop::STATUS_ALARM_mask) != 0)
                  : "");
  }
  if (is_valid) counter("angle / deg", now, fmt::format("{:.9f}", degrees));
  counter("error average", now,
          fmt::format("{:.9g}", static_cast<double>(nodes.error_average) / 2147483648.0));
}

void Timeline::byte(std::size_t uart, uint8_t byte) {
  Text& text = texts_[uart];
  const uint64_t now = picoseconds_now();
  if (text.line.empty()) text.begin_ps = now;
  text.end_ps = now;
  if (byte == '\r') return;
  if (byte != '\n') text.line += static_cast<char>(byte);
  if (byte == '\n' || text.line.size() >= longest_line) flush(uart);
}

void Timeline::flush(std::size_t uart) {
  Text& text = texts_[uart];
  if (!text.line.empty())
    slice({uarts, static_cast<unsigned>(uart) + 1}, text.line, text.begin_ps, text.end_ps);
  text.line.clear();
}

void Timeline::transfer(uint64_t begin_ps, uint64_t end_ps, const BusAccess& access) {
  if (!open_) return;
  const auto next = static_cast<unsigned>(ports_.size()) + 1;
  const auto [port, is_new] = ports_.emplace(access.initiator, next);
  const Track track{bus_, port->second};
  if (is_new) name(track, access.initiator);
  std::string place = targets_.register_name(access.address);
  if (place.empty()) place = targets_.place(access.address);
  if (place.empty()) place = fmt::format("{:#010x}", access.address);
  slice(track, fmt::format("{} {}", access.write ? "write" : "read", place), begin_ps, end_ps,
        fmt::format(R"("address":"{:#010x}","data":"{:#0{}x}","status":"{}")", access.address,
                    access.data, 2 + 2 * access.size, access.status));
}

std::optional<Error> Timeline::finish(uint64_t picoseconds, const std::string& end) {
  event(fmt::format(R"("ph":"i","s":"g","pid":{},"tid":1,"ts":{},"name":{})",
                    static_cast<unsigned>(run), microseconds(picoseconds), quoted(end)));
  cut(picoseconds);
  open_ = false;
  file_.write("\n]}\n");
  return file_.finish();
}

}  // namespace capsoc::trace
