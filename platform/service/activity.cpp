#include "service/activity.h"

#include <algorithm>
#include <string>
#include <systemc>
#include <utility>
#include <vector>

#include "armv7m/core.h"
#include "trace/exception_name.h"
#include "trace/picoseconds.h"

namespace capsoc::service {
namespace {

constexpr uint64_t own_parts = 3;      // of ActivityRecord, which are no exceptions
constexpr uint64_t whole_share = 255;  // of a bin
constexpr uint64_t ps_in_second = 1'000'000'000'000;

std::string name_of(unsigned part) {
  if (part == ActivityRecord::asleep) return "asleep";
  return part == ActivityRecord::thread ? "thread" : trace::exception_name(part);
}

/// 0 to 255 of what is known of each bin; anything above nothing is at least 1.
std::string shares_of(const ActivityRecord::View& view, const ActivityRecord::Row& row) {
  std::string bytes;
  for (std::size_t i = 0; i < row.bins.size(); ++i) {
    const uint64_t begin = view.begin_ps + i * view.width_ps;
    const uint64_t end = std::min(begin + view.width_ps, view.end_ps);
    const uint64_t known =
        std::max<uint64_t>(1, end - std::min(end, std::max(begin, view.known_ps)));
    bytes += static_cast<char>((row.bins[i] * whole_share + known - 1) / known);
  }
  return bytes;
}

}  // namespace

void Activity::begin(std::size_t window) {
  window_ = window;
  if (is_on_) return;
  is_on_ = true;
  clock_changed();
  armv7m::Core& core = soc_->cpu.core();
  record_.begin(trace::picoseconds(sc_core::sc_time_stamp()), parts(core.sleeping()));
  core.add_observer(*this, false, false);
  other_ = std::exchange(core.listeners().sleeps, [this](bool is_asleep) {
    if (other_) other_(is_asleep);
    note(ps_of(soc_->cpu.core().cycles()), is_asleep);
  });
}

void Activity::end() {
  if (!std::exchange(is_on_, false)) return;
  soc_->cpu.core().remove_observer(*this);
  soc_->cpu.core().listeners().sleeps = std::exchange(other_, nullptr);
}

void Activity::clock_changed() {
  const kit::ClockDomain& clock = soc_->clock;
  edge_ = clock.cycles_at(sc_core::sc_time_stamp());
  edge_ps_ = trace::picoseconds(clock.time_of(edge_));
  period_ps_ = ps_in_second % clock.frequency_hz() == 0 ? ps_in_second / clock.frequency_hz() : 0;
}

/// Of a whole period without the kernel, which takes several times as long.
uint64_t Activity::ps_of(uint64_t cycle) const {
  if (period_ps_ != 0 && cycle >= edge_) return edge_ps_ + (cycle - edge_) * period_ps_;
  return trace::picoseconds(soc_->clock.time_of(cycle));
}

uint64_t Activity::parts(bool is_asleep) const {
  const uint64_t active = soc_->cpu.core().state().nvic.active() & ~own_parts;
  if (is_asleep) return active | ActivityRecord::bit(ActivityRecord::asleep);
  return active != 0 ? active : ActivityRecord::bit(ActivityRecord::thread);
}

void Activity::note(uint64_t ps, bool is_asleep, unsigned entered) {
  record_.change(ps, parts(is_asleep), entered);
}

void Activity::entered(const armv7m::Core&, unsigned exception, armv7m::Entry, uint64_t since) {
  note(ps_of(since), false, exception);
}

void Activity::returned(const armv7m::Core& core, unsigned) {
  note(ps_of(core.cycles()), false);
}

void Activity::started(const armv7m::Core& core) {
  note(ps_of(core.cycles()), false, ActivityRecord::thread);
}

Answer Activity::read() const {
  const ActivityRecord::View view =
      record_.view(window_, trace::picoseconds(sc_core::sc_time_stamp()));
  const double known = static_cast<double>(std::max<uint64_t>(1, view.end_ps - view.known_ps));
  Answer answer;
  answer.result = {{"begin_ps", view.begin_ps},
                   {"end_ps", view.end_ps},
                   {"known_ps", view.known_ps},
                   {"bin_ps", view.width_ps}};
  Json& rows = answer.result["rows"] = Json::array();
  for (const ActivityRecord::Row& row : view.rows) {
    Json each = {{"name", name_of(row.part)},
                 {"share", static_cast<double>(row.busy_ps) / known},
                 {"begun", row.begun}};
    each["exception"] = row.part > ActivityRecord::thread ? Json(row.part) : Json();
    if (view.has_slices) {
      std::vector<double> slices;
      for (const auto& [begin, end] : row.slices) {
        slices.push_back(static_cast<double>(begin));
        slices.push_back(static_cast<double>(end - begin));
      }
      answer.add_array(each, "slices", slices);
    } else {
      answer.add_bytes(each, "shares", shares_of(view, row));
    }
    rows.push_back(std::move(each));
  }
  return answer;
}

}  // namespace capsoc::service
