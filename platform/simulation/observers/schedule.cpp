#include "observers/schedule.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "observers/symbols.h"
#include "trace/exception_name.h"

namespace capsoc::run {
namespace {

constexpr uint64_t never = UINT64_MAX;
constexpr std::size_t most_tasks = 1024;  // what a guest can make us keep
constexpr uint32_t longest_name = 32;

unsigned digits(uint64_t value) {
  return value == 0 ? 0 : 64 - static_cast<unsigned>(__builtin_clzll(value));
}

}  // namespace

Schedule::~Schedule() {
  view_.soc().cpu.core().listeners().pended = nullptr;
  view_.soc().cpu.core().remove_observer(*this);
}

std::optional<Error> Schedule::open() {
  times_interrupts_ = settings_.latencies();
  pended_at_.fill(never);
  if (const std::string symbol = settings_.current(); !symbol.empty()) {
    const auto address = address_of(symbol, "tasks.current", view_.program());
    if (!address) return Error{address.error()};
    current_ = address.value();
  }
  armv7m::Core& core = view_.soc().cpu.core();
  if (times_interrupts_)
    core.listeners().pended = [this](unsigned exception) { pended(exception); };
  if (times_interrupts_ || current_) core.add_observer(*this, false, false);
  return std::nullopt;
}

/// The time of a sleeping core lags the time at which a line rises.
void Schedule::pended(unsigned exception) {
  const soc::Soc& soc = view_.soc();
  pended_at_[exception] =
      std::max(soc.cpu.core().cycles(), soc.clock.cycles_at(sc_core::sc_time_stamp()));
}

std::optional<uint32_t> Schedule::read_word(uint32_t address) const {
  uint32_t word = 0;
  if (!view_.soc().cpu.core().debug_read(address, &word, 4)) return std::nullopt;
  return word;
}

std::string Schedule::name_of(uint32_t task) const {
  std::string number = fmt::format("{:#010x}", task);
  const long long offset = settings_.name_offset();
  if (offset < 0) return number;
  std::optional<uint32_t> at = task + static_cast<uint32_t>(offset);
  if (settings_.name_is_pointer()) at = read_word(*at);
  if (!at) return number;
  std::string name;
  for (char c = 0; name.size() < longest_name; name += c) {
    const auto address = *at + static_cast<uint32_t>(name.size());
    if (!view_.soc().cpu.core().debug_read(address, &c, 1) || c == 0) break;
  }
  return name.empty() ? number : printable(name, longest_name);
}

void Schedule::charge(uint64_t until) {
  if (current_) tasks_[running_].cycles += until - since_;
  since_ = until;
}

/// In Thread mode the present task has the processor.
void Schedule::look_at_task() {
  if (!current_) return;
  const uint32_t task = read_word(*current_).value_or(0);
  running_ = tasks_.count(task) == 0 && tasks_.size() >= most_tasks ? 0 : task;
  if (running_ == last_task_ || running_ == 0) return;
  Task& entered = tasks_[running_];
  if (entered.name.empty()) entered.name = name_of(task);
  ++entered.switches;
  last_task_ = running_;
}

/// The handler's first instruction comes after all.
void Schedule::note_entry() {
  if (!entry_) return;
  Waits& waits = waits_[entry_->exception];
  ++waits.count;
  waits.sum += entry_->waited;
  waits.least = std::min(waits.least, entry_->waited);
  waits.most = std::max(waits.most, entry_->waited);
  ++waits.by_size[digits(entry_->waited)];
  entry_.reset();
}

void Schedule::entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how,
                       uint64_t since) {
  charge(since);
  running_ = 0;
  if (!times_interrupts_) return;
  if (how == armv7m::Entry::displaces && entry_) {
    pended_at_[entry_->exception] = core.cycles() - entry_->waited;  // waits on
    entry_.reset();
  }
  note_entry();
  if (pended_at_[exception] == never) return;
  entry_ = Entry{exception, core.cycles() - std::min(core.cycles(), pended_at_[exception])};
  pended_at_[exception] = never;
}

void Schedule::returned(const armv7m::Core& core, unsigned) {
  charge(core.cycles());
  if (core.state().ipsr == 0) look_at_task();
}

void Schedule::started(const armv7m::Core& core) {
  charge(core.cycles());
  running_ = 0;
}

void Schedule::Task::visit(Archive& archive) {
  archive("name", name);
  archive("cycles", cycles);
  archive("switches", switches);
}

void Schedule::Waits::visit(Archive& archive) {
  archive("count", count);
  archive("sum", sum);
  archive("least", least);
  archive("most", most);
  archive("by_size", by_size);
}

void Schedule::Entry::visit(Archive& archive) {
  archive.at_most("exception", exception, 63U);
  archive("waited", waited);
}

void Schedule::visit_gathered(Archive& archive) {
  std::vector<uint32_t> addresses;
  std::vector<Task> tasks;
  for (const auto& [address, task] : tasks_) {
    addresses.push_back(address);
    tasks.push_back(task);
  }
  archive.sequence("addresses", addresses, most_tasks + 1);
  archive.sequence("tasks", tasks, most_tasks + 1);
  archive("running", running_);
  archive("last_task", last_task_);
  archive("since", since_);
  archive("pended_at", pended_at_);
  archive("waits", waits_);
  archive("entry", entry_);
  if (!archive.loading()) return;
  if (addresses.size() != tasks.size()) return archive.refuse("has tasks without addresses");
  tasks_.clear();
  for (std::size_t i = 0; i < tasks.size(); ++i) tasks_[addresses[i]] = std::move(tasks[i]);
}

void Schedule::finish(RunResult& result) {
  const armv7m::Core& core = view_.soc().cpu.core();
  if (current_) {
    charge(core.cycles());
    tasks_[0].name = "(no task)";
    for (const auto& [address, task] : tasks_)
      result.tasks.push_back({task.name, address, task.cycles, task.switches});
  }
  note_entry();
  for (unsigned exception = 0; exception < waits_.size(); ++exception) {
    const Waits& waits = waits_[exception];
    if (waits.count == 0) continue;
    InterruptWait about{exception,   trace::exception_name(exception),
                        waits.count, waits.least,
                        waits.most,  waits.sum,
                        {}};
    for (unsigned size = 0; size < waits.by_size.size(); ++size) {
      if (waits.by_size[size] == 0) continue;
      const uint64_t behind = uint64_t{1} << size;
      about.histogram.push_back({behind / 2, behind - 1, waits.by_size[size]});
    }
    result.interrupt_waits.push_back(std::move(about));
  }
}

}  // namespace capsoc::run
