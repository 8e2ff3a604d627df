#include "inject/injector.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "armv7m/observer.h"
#include "base/input_file.h"
#include "base/printable.h"
#include "base/split.h"
#include "kit/seconds.h"

namespace capsoc::inject {
namespace {

constexpr uint64_t largest_file = 64U << 20U;
/// The last ones before a fault at an instruction are executed one by one.
constexpr uint64_t stepped = 4096;

Result<std::vector<Fault>> faults_of(const run::InjectSettings& settings) {
  std::vector<Fault> faults;
  // An empty variable of a script, where a fault was to be.
  if (settings.faults.empty() && !settings.faults.about().option.empty())
    return Error{fmt::format("{} is empty; leave it out, or name a fault", settings.faults.name())};
  for (const std::string& line : split(settings.faults(), ',')) {
    const std::string origin = fmt::format("{} '{}'", settings.faults.name(), printable(line, 120));
    auto fault = parse_fault(line);
    if (!fault) return Error{fmt::format("{}: {}", origin, fault.error())};
    fault.value().origin = origin;
    faults.push_back(std::move(fault.value()));
  }
  const std::string& file = settings.file();
  if (file.empty()) return faults;
  const auto text = read_input(file, {"name a file of faults, one a line", largest_file});
  if (!text) return Error{text.error()};
  auto more = parse_faults(file, text.value());
  if (!more) return more;
  for (Fault& fault : more.value()) faults.push_back(std::move(fault));
  return faults;
}

}  // namespace

/// Looks after each instruction whether one is reached, or a stuck bit was written.
class Injector::Watch final : public armv7m::Observer {
 public:
  explicit Watch(Injector& injector) : injector_(injector) {}
  void issued(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void retired(const armv7m::Core&, const armv7m::DecodedOp&) override { injector_.retired(); }
  void entered(const armv7m::Core&, unsigned, armv7m::Entry, uint64_t) override {
    injector_.retired();
  }
  void returned(const armv7m::Core&, unsigned) override { injector_.retired(); }
  void accessed(const armv7m::Core&, const armv7m::DirectAccess&) override {}
  void started(const armv7m::Core&) override {}

 private:
  Injector& injector_;
};

Result<std::unique_ptr<Injector>> Injector::make(
    const run::InjectSettings& settings, soc::Soc& soc, const run::CoprocessorBackend& backend,
    const std::vector<const loader::ElfImage*>& images) {
  auto faults = faults_of(settings);
  if (!faults) return Error{faults.error()};
  if (faults.value().empty()) return std::unique_ptr<Injector>();
  auto injector = std::make_unique<Injector>(soc);
  const Places places(soc, backend, images);
  for (Fault& fault : faults.value()) {
    const std::string origin = fault.origin;
    if (const auto error = injector->add(std::move(fault), places, 0))
      return Error{fmt::format("{}: {}", origin, error->text)};
  }
  injector->of_settings_ = injector->faults_.size();
  injector->watch_instructions();
  return injector;
}

Injector::Injector(soc::Soc& soc)
    : soc_(soc), position_{soc}, watch_(std::make_unique<Watch>(*this)) {
  listen();
}

Injector::~Injector() {
  if (is_watching_) soc_.cpu.core().remove_observer(*watch_);
}

std::optional<Error> Injector::add(Fault fault, const Places& places, uint64_t sample) {
  position_.sample = sample;
  if (is_past(fault.when))
    return Error{"its time is past; go back in time, or leave the time out: it begins now"};
  auto injected = std::make_unique<Injected>();
  injected->outcome.fault = to_text(fault);
  injected->fault = std::move(fault);
  if (auto error = place(places, *injected)) return error;
  faults_.push_back(std::move(injected));
  samples_.connect(soc_);
  interrupts_.connect(soc_);
  return std::nullopt;
}

std::optional<Error> Injector::place(const Places& places, Injected& injected) {
  Fault& fault = injected.fault;
  if (BusFaults::takes(fault)) return accesses_.add(injected, places);
  if (SampleFaults::takes(fault)) return samples_.add(injected);
  if (ClockFaults::takes(fault)) {
    clock_.add(injected);
    return std::nullopt;
  }
  if (fault.kind == Fault::Kind::lose_interrupt) return interrupts_.add(injected);
  if (fault.kind == Fault::Kind::raise_interrupt) {
    const auto line = interrupt_line(fault.place);
    if (!line) return Error{line.error()};
    raised_.push_back(&injected);
    return std::nullopt;
  }
  auto found = places.find(fault.place, fault.bit);
  if (!found) return Error{found.error()};
  fault.bit = found.value().bit;
  bits_.push_back({&injected, std::move(found.value())});
  return std::nullopt;
}

void Injector::listen() {
  // Before the sink takes it.
  listening_.push_back(
      soc_.adc.conversions.listen([this](uint64_t, const peripherals::SensorSample& sample) {
        position_.sample = sample.number;
        position_.converted = soc_.clock.cycles_at(sc_core::sc_time_stamp());
        const bool waits = std::any_of(faults_.begin(), faults_.end(), [](const auto& injected) {
          return !injected->is_over && injected->fault.when.unit == When::Unit::sample;
        });
        if (waits) wake();
      }));
  listening_.push_back(
      soc_.coprocessor.results.listen([this](uint64_t, const coprocessor::Nodes&, uint64_t) {
        for (Bit& bit : bits_) {
          if (!bit.holds || bit.holds_itself || bit.placed.place->writer() != Place::Writer::result)
            continue;
          bit.is_due = true;
          wake();
        }
      }));
  // A cycle is another time then.
  soc_.clock.on_change([this] { wake(); });
}

/// Ends the run of the core under way, wherever this is called.
void Injector::wake() {
  soc_.cpu.pause_soon();
  soc_.cpu.core().attention();
}

std::optional<Error> Injector::begin_from(const sc_core::sc_time& time, uint64_t sample,
                                          bool is_snapshot) {
  position_.sample = sample;
  const uint64_t cycle = soc_.cpu.core().cycles(), instruction = soc_.cpu.core().instructions();
  for (const auto& injected : faults_) {
    const When& when = injected->fault.when;
    // The kernel is not there yet.
    const bool is_before =
        when.unit == When::Unit::time && sc_core::sc_time::from_value(when.value) < time;
    if (!is_before && !is_past(when)) continue;
    if (!is_snapshot)
      return Error{fmt::format(
          "{}: its time is past: the run resumes from {:.12g} s, cycle {}, instruction {}, sample "
          "{}; name a later time, or leave the fault out: what it did is in the checkpoint",
          injected->fault.origin, kit::to_seconds(time), cycle, instruction, sample)};
    injected->is_over = true;
    injected->outcome.note = "before the snapshot from which the run resumes";
  }
  return std::nullopt;
}

bool Injector::is_past(const When& when) const {
  switch (when.unit) {
    case When::Unit::time:
      return sc_core::sc_time::from_value(when.value) < sc_core::sc_time_stamp();
    case When::Unit::cycle:
      return when.value < soc_.cpu.core().cycles();
    case When::Unit::instruction:
      return when.value < soc_.cpu.core().instructions();
    case When::Unit::sample:
      return when.value <= position_.sample;
  }
  return false;
}

void Injector::restored() {
  samples_.restored(soc_);
  wake();
}

/// When a fault that has not begun is to be looked at.
sc_core::sc_time Injector::time_of(const Injected& injected) const {
  const When& when = injected.fault.when;
  const uint64_t done = soc_.cpu.core().instructions();
  switch (when.unit) {
    case When::Unit::time:
      return sc_core::sc_time::from_value(when.value);
    case When::Unit::cycle:
      return soc_.clock.time_of(when.value);
    case When::Unit::instruction:
      // An instruction takes at least half a cycle, except a folded IT.
      if (when.value > done + stepped)
        return soc_.clock.time_of(soc_.cpu.core().cycles() + (when.value - done) / 2);
      return when.value > done ? sc_core::sc_max_time() : sc_core::SC_ZERO_TIME;
    case When::Unit::sample:
      if (when.value != position_.sample) return sc_core::sc_max_time();
      return soc_.clock.time_of(position_.converted + when.cycles);
  }
  return sc_core::sc_max_time();
}

sc_core::sc_time Injector::next_of(const Bit& bit) const {
  const Injected& injected = *bit.injected;
  if (injected.is_over) return sc_core::sc_max_time();
  if (!bit.holds && position_.reached(injected.fault.when)) return bit.placed.place->ready_at();
  if (!bit.holds) return time_of(injected);
  const sc_core::sc_time end = injected.end.value_or(sc_core::sc_max_time());
  return bit.is_due ? std::min(end, bit.placed.place->ready_at()) : end;
}

sc_core::sc_time Injector::next() const {
  sc_core::sc_time soonest = clock_.next();
  for (const Bit& bit : bits_) soonest = std::min(soonest, next_of(bit));
  for (const Injected* injected : raised_)
    if (!injected->is_over) soonest = std::min(soonest, time_of(*injected));
  for (const Injected* injected : waiting()) soonest = std::min(soonest, time_of(*injected));
  return soonest;
}

/// Those of accesses and of the clock that have not begun.
std::vector<const Injected*> Injector::waiting() const {
  std::vector<const Injected*> all = accesses_.waiting();
  const std::vector<const Injected*> more = clock_.waiting();
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

void Injector::apply(Bit& bit) {
  Injected& injected = *bit.injected;
  const auto change = bit.placed.place->change(
      [&](uint64_t value) { return with_bit(injected.fault, value, injected.fault.bit); });
  if (!change) return;
  position_.note(injected, change->before, change->after);
  bit.is_due = false;
  bit.holds = injected.fault.is_stuck();
  bit.holds_itself = bit.holds && bit.placed.place->hold(
                                      bit.placed.bit, injected.fault.kind == Fault::Kind::stuck1);
  injected.is_over = !bit.holds;
  if (change->before == change->after && !bit.holds)
    injected.outcome.note = "nothing changed: the bit does not exist there, or cannot be changed";
}

/// A pulse: the interrupt stays pending.
void Injector::raise(Injected& injected) {
  const unsigned line = interrupt_line(injected.fault.place).value();
  const armv7m::Nvic& nvic = soc_.cpu.core().state().nvic;
  const unsigned exception = armv7m::exception::first_interrupt + line;
  const bool before = nvic.is_pending(exception);
  if (nvic.line_is_high(exception)) {
    injected.outcome.note = "nothing changed: the line was high";
  } else {
    soc_.cpu.set_interrupt(line, true);
    soc_.cpu.set_interrupt(line, false);
  }
  position_.note(injected, before ? 1 : 0, nvic.is_pending(exception) ? 1 : 0);
  injected.is_over = true;
}

/// The end of a stuck bit's time: it keeps its value.
void Injector::release(Bit& bit, const sc_core::sc_time& now) {
  if (!bit.holds || !bit.injected->end || now < *bit.injected->end) return;
  if (bit.holds_itself) bit.placed.place->release(bit.placed.bit);
  bit.holds = false;
  bit.injected->is_over = true;
}

sc_core::sc_time Injector::pause(const sc_core::sc_time& now) {
  for (Bit& bit : bits_) {
    release(bit, now);
    if (bit.injected->is_over) continue;
    const bool begins = !bit.holds && position_.reached(bit.injected->fault.when);
    if (begins || bit.is_due) apply(bit);
  }
  for (Injected* injected : raised_)
    if (!injected->is_over && position_.reached(injected->fault.when)) raise(*injected);
  accesses_.pause();
  clock_.pause(now);
  watch_instructions();
  return next();
}

/// Whether the processor is to be looked at after each instruction from here on.
bool Injector::wants_instructions() const {
  const uint64_t done = soc_.cpu.core().instructions();
  const auto is_near = [done](const Injected& injected) {
    const When& when = injected.fault.when;
    return !injected.is_over && !injected.outcome.applied && when.unit == When::Unit::instruction &&
           when.value <= done + stepped;
  };
  const std::vector<const Injected*> waiting = this->waiting();
  return std::any_of(
             bits_.begin(), bits_.end(),
             [&](const Bit& bit) {
               return is_near(*bit.injected) ||
                      (bit.holds && bit.placed.place->writer() == Place::Writer::instruction);
             }) ||
         std::any_of(raised_.begin(), raised_.end(),
                     [&](const Injected* injected) { return is_near(*injected); }) ||
         std::any_of(waiting.begin(), waiting.end(),
                     [&](const Injected* injected) { return is_near(*injected); });
}

void Injector::watch_instructions() {
  const bool wants = wants_instructions();
  if (wants == is_watching_) return;
  is_watching_ = wants;
  if (wants)
    soc_.cpu.core().add_observer(*watch_, true, false);
  else
    soc_.cpu.core().remove_observer(*watch_);
}

void Injector::retired() {
  bool is_wanted = false;
  for (const auto& injected : faults_)
    is_wanted = is_wanted || (!injected->is_over && !injected->outcome.applied &&
                              injected->fault.when.unit == When::Unit::instruction &&
                              position_.reached(injected->fault.when));
  for (Bit& bit : bits_) {
    if (!bit.holds || bit.placed.place->writer() != Place::Writer::instruction) continue;
    bool differs = false;
    bit.placed.place->change([&](uint64_t value) {
      differs = with_bit(bit.injected->fault, value, bit.injected->fault.bit) != value;
      return value;
    });
    bit.is_due = bit.is_due || differs;
    is_wanted = is_wanted || differs;
  }
  if (is_wanted) wake();
}

void Injector::visit(Archive& archive) {
  if (archive.loading()) return;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const Injected& injected = *faults_[i];
    const bool begins_later = !injected.outcome.applied && i < of_settings_;
    const bool has_ended = injected.end && *injected.end <= sc_core::sc_time_stamp();
    if (injected.is_over || begins_later || has_ended) continue;
    archive.refuse(fmt::format(
        "cannot be saved while a fault lasts ({}); save before it begins or after its end",
        injected.outcome.fault));
  }
}

bool Injector::is_over() const {
  return std::all_of(faults_.begin(), faults_.end(),
                     [](const auto& injected) { return injected->is_over; });
}

std::vector<run::FaultOutcome> Injector::added() const {
  std::vector<run::FaultOutcome> outcomes;
  for (std::size_t i = of_settings_; i < faults_.size(); ++i)
    outcomes.push_back(faults_[i]->outcome);
  return outcomes;
}

void Injector::finish(run::RunResult& result) {
  for (const auto& injected : faults_) {
    run::FaultOutcome& outcome = injected->outcome;
    if (!outcome.applied && outcome.note.empty())
      outcome.note = position_.reached(injected->fault.when) ? "the run ended before it could act"
                                                             : "the run ended before its time";
    result.faults.push_back(outcome);
  }
}

}  // namespace capsoc::inject
