#include "regress/pin_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/splitmix64.h"

namespace capsoc::regress {
namespace {

constexpr unsigned edges_in_reset = 4;
constexpr std::size_t most_shown = 16;

rtl::Operation operation_of(const Event& event) {
  using Kind = rtl::Operation::Kind;
  const Kind kind = event.kind == Event::Kind::sample  ? Kind::sample
                    : event.kind == Event::Kind::write ? Kind::write
                    : event.kind == Event::Kind::read  ? Kind::read
                                                       : Kind::reset;
  return {kind, event.edge, event.offset_or_u, event.value_or_v, event.flag, event.strobes};
}

void keep(std::deque<Event>& last, const Event& event) {
  last.push_back(event);
  if (last.size() > most_shown) last.pop_front();
}

}  // namespace

PinReplay::PinReplay(rtl::RtlLibrary::Handle library)
    : library_(std::move(library)),
      api_(library_->api()),
      instance_(api_.create(), api_.destroy),
      pins_(*api_.pins(instance_.get())) {
  pins_ = {};
  for (unsigned edge = 0; edge < edges_in_reset; ++edge) {
    api_.eval(instance_.get());
    api_.clock(instance_.get());
  }
  pins_.presetn = 1;
}

void PinReplay::feed(const std::vector<Event>& events, uint64_t known) {
  events_.insert(events_.end(), events.begin(), events.end());
  // What is on the pins in an interval may belong to an event two edges ahead.
  while (!difference_ && now_ + 2 < known) interval();
}

void PinReplay::interval() {
  while (!events_.empty() && events_.front().edge < now_) events_.pop_front();
  drive();
  api_.eval(instance_.get());
  check();
  if (!difference_) clock();
}

/// What stands on the pins in this interval.
void PinReplay::drive() {
  const uint64_t noise = splitmix64(now_);
  pins_.presetn = 1;
  pins_.psel = pins_.penable = pins_.sample_valid = 0;
  pins_.pwrite = noise & 1U;
  pins_.pstrb = noise >> 10U & coprocessor::all_strobes;
  pins_.paddr = noise >> 1U & 0xFFCU;
  pins_.pwdata = static_cast<uint32_t>(noise >> 32U);
  pins_.sample_u = static_cast<uint32_t>(noise >> 8U);
  pins_.sample_v = static_cast<uint32_t>(noise >> 16U);
  pins_.sample_clip = noise >> 9U & 1U;
  access_ = sample_ = nullptr;
  for (const Event& event : events_) {
    if (event.edge > now_ + 2) break;
    switch (event.kind) {
      case Event::Kind::reset:
        if (event.edge == now_) pins_.presetn = 0;
        break;
      case Event::Kind::level:
        if (event.edge != now_) break;
        interrupt_ = event.flag;
        idle_ = event.answer;
        break;
      case Event::Kind::sample:
        if (event.edge != now_ + 1) break;
        sample_ = &event;
        pins_.sample_valid = 1;
        pins_.sample_u = event.offset_or_u;
        pins_.sample_v = event.value_or_v;
        pins_.sample_clip = event.flag;
        break;
      case Event::Kind::read:  // shows what the edge before its interval left
        if (event.edge == now_) transfer(event, true);
        if (event.edge == now_ + 1) transfer(event, false);
        break;
      case Event::Kind::write:  // acts at the edge after its interval
        if (event.edge == now_ + 1) transfer(event, true);
        if (event.edge == now_ + 2) transfer(event, false);
        break;
      case Event::Kind::look:
        break;
    }
  }
}

void PinReplay::transfer(const Event& event, bool access) {
  const bool write = event.kind == Event::Kind::write;
  // Without strobes it would be a write of the whole word.
  if (event.strobes != coprocessor::all_strobes && !has(CAPSOC_RTL_PSTRB)) return;
  pins_.psel = 1;
  pins_.penable = access ? 1 : 0;
  pins_.pwrite = write ? 1 : 0;
  pins_.pstrb = write ? event.strobes : 0;
  pins_.paddr = static_cast<uint16_t>(event.offset_or_u);
  if (write) pins_.pwdata = event.value_or_v;
  if (access) access_ = &event;
}

void PinReplay::check() {
  if (sample_ != nullptr) {
    ++counts_.samples;
    keep(samples_, *sample_);
    if (has(CAPSOC_RTL_SAMPLE_READY) && (pins_.sample_ready != 0) != sample_->answer)
      differ("sample_ready", sample_->answer ? 1 : 0, pins_.sample_ready);
  }
  if (access_ != nullptr) {
    keep(transfers_, *access_);
    check_access(*access_);
  }
  if (pins_.presetn == 0) return;
  if (has(CAPSOC_RTL_IRQ) && (pins_.irq != 0) != interrupt_)
    differ("irq", interrupt_ ? 1 : 0, pins_.irq);
  if (has(CAPSOC_RTL_IDLE) && (pins_.idle != 0) != idle_) differ("idle", idle_ ? 1 : 0, pins_.idle);
}

void PinReplay::check_access(const Event& event) {
  const bool read = event.kind == Event::Kind::read;
  ++(read ? counts_.reads : counts_.writes);
  const std::string what =
      fmt::format("{} {}", read ? "read of" : "write of", rtl::register_name(event.offset_or_u));
  if (has(CAPSOC_RTL_PREADY) && pins_.pready == 0) differ("pready of the " + what, 1, 0);
  if (has(CAPSOC_RTL_PSLVERR) && (pins_.pslverr == 0) != event.answer)
    differ("pslverr of the " + what, event.answer ? 0 : 1, pins_.pslverr);
  if (read && event.answer && pins_.prdata != event.value_or_v)
    differ(what, event.value_or_v, pins_.prdata);
}

void PinReplay::clock() {
  if (!waves_.empty() && !waves_open_ && now_ >= waves_begin_) {
    api_.open_waves(instance_.get(), waves_.c_str());
    waves_open_ = true;
  }
  ++now_;
  ++counts_.edges;
  if (waves_open_)
    api_.wave_time(instance_.get(), now_ * period_ns_, now_ * period_ns_ + period_ns_ / 2);
  api_.clock(instance_.get());
}

void PinReplay::differ(std::string what, uint64_t model, uint64_t rtl) {
  if (difference_) return;
  difference_ = rtl::Difference{
      now_, std::move(what), fmt::format("{:#x}", model), fmt::format("{:#x}", rtl), "", ""};
}

std::string PinReplay::report() const {
  if (!difference_) return {};
  std::string text = fmt::format(
      "model and RTL differ at their pins, in the interval after edge {}\n"
      "  what        {}\n"
      "  model       {}\n"
      "  rtl         {}\n",
      difference_->cycle, difference_->what, difference_->model, difference_->rtl);
  const auto list = [&](const char* title, const std::deque<Event>& events) {
    text += fmt::format("last {} (at their edges, the newest last)\n", title);
    for (const Event& event : events) text += rtl::describe(operation_of(event)) + "\n";
  };
  list("accesses", transfers_);
  list("samples", samples_);
  return text;
}

std::optional<Error> PinReplay::open_waves(const std::string& file, uint64_t begin,
                                           unsigned period_ns) {
  // Now, so that what cannot be written is known before a long way.
  if (!api_.open_waves(instance_.get(), file.c_str()))
    return Error{file + ": cannot be written; name another place for the waves"};
  api_.close_waves(instance_.get());
  waves_ = file;
  waves_begin_ = begin;
  period_ns_ = period_ns;
  return std::nullopt;
}

void PinReplay::close_waves() {
  api_.close_waves(instance_.get());
  waves_.clear();
  waves_open_ = false;
}

}  // namespace capsoc::regress
