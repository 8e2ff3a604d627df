#include "inject/stream_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "base/nearest.h"
#include "base/printable.h"
#include "kit/seconds.h"
#include "soc/board_map.h"

namespace capsoc::inject {

bool Position::reached(const When& when) const {
  switch (when.unit) {
    case When::Unit::time:
      return sc_core::sc_time_stamp() >= sc_core::sc_time::from_value(when.value);
    case When::Unit::cycle:
      return soc.clock.cycles_at(sc_core::sc_time_stamp()) >= when.value;
    case When::Unit::instruction:
      return soc.cpu.core().instructions() >= when.value;
    case When::Unit::sample:
      return sample > when.value ||
             (sample == when.value &&
              soc.clock.cycles_at(sc_core::sc_time_stamp()) >= converted + when.cycles);
  }
  return false;
}

void Position::note(Injected& injected, uint64_t before, uint64_t after) const {
  run::FaultOutcome& outcome = injected.outcome;
  if (before != after) ++outcome.changes;
  if (outcome.applied) return;
  outcome.applied = true;
  outcome.time_s = kit::to_seconds(sc_core::sc_time_stamp());
  outcome.cycle = soc.clock.cycles_at(sc_core::sc_time_stamp());
  outcome.instruction = soc.cpu.core().instructions();
  outcome.before = before;
  outcome.after = after;
  if (injected.fault.duration && !injected.end)
    injected.end =
        sc_core::sc_time_stamp() + sc_core::sc_time::from_value(*injected.fault.duration);
}

bool SampleFaults::takes(const Fault& fault) {
  if (fault.is_of_bit()) return fault.place == "sin" || fault.place == "cos";
  return fault.kind == Fault::Kind::lose_sample || fault.kind == Fault::Kind::double_sample ||
         fault.kind == Fault::Kind::freeze;
}

std::optional<Error> SampleFaults::add(Injected& injected) {
  if (injected.fault.is_of_bit() && injected.fault.bit > 31)
    return Error{fmt::format("{} has no bit {}; its bits are 0 to 31", injected.fault.place,
                             injected.fault.bit)};
  faults_.push_back(&injected);
  return std::nullopt;
}

/// The newest sample of a restored state is in the converter's registers.
void SampleFaults::restored(soc::Soc& soc) {
  last_.emplace();
  last_->u = static_cast<int32_t>(soc.adc.data_u.get());
  last_->v = static_cast<int32_t>(soc.adc.data_v.get());
}

void SampleFaults::connect(soc::Soc& soc) {
  if (faults_.empty()) return;
  soc.adc.set_sink([this](const peripherals::SensorSample& sample) { pass(sample); });
}

bool SampleFaults::is_acting(Injected& injected) const {
  if (injected.end && sc_core::sc_time_stamp() >= *injected.end) injected.is_over = true;
  return !injected.is_over && position_.reached(injected.fault.when);
}

/// A word of a channel, on its way.
void SampleFaults::change(Injected& injected, int32_t& word, int32_t last) const {
  const uint32_t before = static_cast<uint32_t>(word), bit = uint32_t{1} << injected.fault.bit;
  uint32_t after = before;
  switch (injected.fault.kind) {
    case Fault::Kind::flip:
      after ^= bit;
      injected.is_over = true;
      break;
    case Fault::Kind::stuck0:
      after &= ~bit;
      break;
    case Fault::Kind::stuck1:
      after |= bit;
      break;
    default:
      after = static_cast<uint32_t>(last);
  }
  word = static_cast<int32_t>(after);
  position_.note(injected, before, after);
}

void SampleFaults::pass(peripherals::SensorSample sample) {
  const peripherals::SensorSample converted = sample;
  unsigned times = 1;
  for (Injected* injected : faults_) {
    if (!is_acting(*injected)) continue;
    const Fault& fault = injected->fault;
    if (fault.kind == Fault::Kind::lose_sample || fault.kind == Fault::Kind::double_sample) {
      const unsigned now = fault.kind == Fault::Kind::lose_sample ? 0 : 2;
      position_.note(*injected, times, now);
      times = now;
      injected->is_over = !fault.duration;
      continue;
    }
    const peripherals::SensorSample& last = last_ ? *last_ : converted;
    if (fault.place == "sin")
      change(*injected, sample.u, last.u);
    else
      change(*injected, sample.v, last.v);
  }
  for (; times > 0; --times) position_.soc.coprocessor.sample(sample);
  last_ = sample;
}

std::optional<Error> InterruptFaults::add(Injected& injected) {
  const auto line = interrupt_line(injected.fault.place);
  if (!line) return Error{line.error()};
  lost_.push_back({&injected, line.value()});
  return std::nullopt;
}

void InterruptFaults::connect(soc::Soc& soc) {
  if (lost_.empty()) return;
  soc.cpu.set_interrupt_gate([this](unsigned line, bool level) { return passes(line, level); });
}

bool InterruptFaults::passes(unsigned line, bool level) {
  for (Lost& lost : lost_) {
    Injected& injected = *lost.injected;
    if (injected.end && sc_core::sc_time_stamp() >= *injected.end) injected.is_over = true;
    if (lost.line != line || !level || injected.is_over || !position_.reached(injected.fault.when))
      continue;
    position_.note(injected, 1, 0);
    injected.is_over = !injected.fault.duration;
    return false;
  }
  return true;
}

Result<unsigned> interrupt_line(const std::string& name) {
  char* end = nullptr;
  const unsigned long number = std::strtoul(name.c_str(), &end, 10);
  if (name.front() >= '0' && name.front() <= '9' && *end == 0) {
    if (number < armv7m::Core::interrupt_count) return static_cast<unsigned>(number);
    return Error{fmt::format("there is no interrupt {}; they are 0 to {}", printable(name, 20),
                             armv7m::Core::interrupt_count - 1)};
  }
  std::vector<std::string> names;
  for (const bus::MapEntry& entry : soc::board_map())
    for (const bus::InterruptWire& wire : entry.interrupts) {
      if (wire.line == bus::nmi_line) continue;
      const std::string full = entry.name + "." + wire.output;
      names.push_back(entry.interrupts.size() == 1 ? entry.name : full);
      if (name == full || (name == entry.name && entry.interrupts.size() == 1))
        return static_cast<unsigned>(wire.line);
    }
  return Error{fmt::format("no interrupt is called '{}'; did you mean {}?", printable(name, 80),
                           nearest_names(name, std::move(names)))};
}

}  // namespace capsoc::inject
