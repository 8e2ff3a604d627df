#include "service/events.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/nearest.h"
#include "base/printable.h"
#include "kit/guest_error.h"
#include "kit/seconds.h"
#include "service/uart_tap.h"
#include "trace/exception_name.h"

namespace capsoc::service {
namespace {

constexpr unsigned first_fault = 3, last_fault = 6;  // HardFault to UsageFault

double now_s() {
  return kit::to_seconds(sc_core::sc_time_stamp());
}

}  // namespace

Events::~Events() {
  if (looking_) soc_->cpu.core().remove_observer(*this);
  listen_to_guest(false);
}

const std::vector<std::string>& Events::kinds() {
  static const std::vector<std::string> all = {"exception", "fault", "guest_error", "sample",
                                               "uart",      "pins",  "verdict"};
  return all;
}

std::optional<Error> Events::subscribe(const std::vector<std::string>& wanted,
                                       std::array<UartTap, soc::Soc::uart_count>& uarts) {
  const auto has = [&](const char* kind) {
    return std::find(wanted.begin(), wanted.end(), kind) != wanted.end();
  };
  for (const std::string& kind : wanted)
    if (std::find(kinds().begin(), kinds().end(), kind) == kinds().end())
      return Error{fmt::format("there is no kind of events '{}'; did you mean {}?",
                               printable(kind, 80), nearest_names(printable(kind, 80), kinds()))};
  subscribed_ = wanted;
  exceptions_ = has("exception");
  faults_ = has("fault");
  samples_ = has("sample");
  if (has("verdict") && !verdicts_) verdict_ = read_verdict_();
  verdicts_ = has("verdict");
  look();
  listen_to_guest(has("guest_error"));
  listening_.clear();
  for (std::size_t n = 0; n < uarts.size(); ++n) {
    uarts[n].on_line = nullptr;
    if (has("uart"))
      uarts[n].on_line = [this, n](const std::string& line) {
        add({{"kind", "uart"}, {"time_s", now_s()}, {"uart", n}, {"line", line}}, line.size());
      };
  }
  if (!has("pins")) return std::nullopt;
  std::size_t number = 0;
  for (cmsdk::Gpio* gpio : soc_->gpios()) {
    listening_.push_back(gpio->outputs.listen([this, number](uint16_t levels, uint16_t driven) {
      add({{"kind", "pins"},
           {"time_s", now_s()},
           {"gpio", number},
           {"levels", levels},
           {"driven", driven}});
    }));
    ++number;
  }
  return std::nullopt;
}

void Events::listen_to_guest(bool wanted) {
  if (wanted == listening_to_guest_) return;
  listening_to_guest_ = wanted;
  if (!wanted) return kit::set_guest_error_listener({});
  kit::set_guest_error_listener([this](std::string_view source, std::string_view text) {
    add({{"kind", "guest_error"}, {"time_s", now_s()}, {"source", source}, {"text", text}},
        source.size() + text.size());
  });
}

void Events::sample(uint64_t number, const metrics::RecordedSample& sample) {
  if (!samples_) return;
  Json event = {{"kind", "sample"}, {"time_s", now_s()}, {"sample", number}};
  const bool has_angle = sample.result && sample.result->angle_valid;
  event["angle_deg"] = has_angle ? Json(sample.result->angle * (360 / 4294967296.0)) : Json();
  add(std::move(event));
}

void Events::look_for_verdict() {
  if (!verdicts_) return;
  Json now = read_verdict_();
  if (now == verdict_) return;
  verdict_ = now;
  if (now.is_null()) return;
  Json event = {{"kind", "verdict"}, {"time_s", now_s()}};
  event.update(now);
  add(std::move(event), now.dump().size());
}

void Events::watch_exception(int number, std::function<void()> on_entry) {
  watched_ = number;
  on_entry_ = std::move(on_entry);
  look();
}

void Events::look() {
  const bool wanted = exceptions_ || faults_ || watched_ >= 0;
  if (wanted == looking_) return;
  looking_ = wanted;
  if (wanted)
    soc_->cpu.core().add_observer(*this, false, false);
  else
    soc_->cpu.core().remove_observer(*this);
}

void Events::entered(const armv7m::Core& core, unsigned exception, armv7m::Entry, uint64_t) {
  const auto told = [&](const char* kind) {
    add({{"kind", kind},
         {"time_s", kit::to_seconds(soc_->clock.time_of(core.cycles()))},
         {"exception", exception},
         {"name", trace::exception_name(exception)}});
  };
  if (exceptions_) told("exception");
  if (faults_ && exception >= first_fault && exception <= last_fault) told("fault");
  if (static_cast<int>(exception) == watched_) on_entry_();
}

/// `line`: bytes of a text in it.
void Events::add(Json event, std::size_t line) {
  // By the event's own time: the kernel may lag the processor.
  if (event.at("time_s").get<double>() < kit::to_seconds(told_)) return;
  constexpr std::size_t of_an_event = 120, of_a_byte = 6;
  const std::size_t bytes = of_an_event + of_a_byte * line;
  if (bytes_ + bytes > most_bytes) {
    ++lost_;
    return;
  }
  bytes_ += bytes;
  events_.push_back(std::move(event));
}

sc_core::sc_time Events::told() const {
  return std::max(told_, sc_core::sc_time_stamp());
}

Json Events::take() {
  Json all = Json::array();
  for (Json& event : events_) all.push_back(std::move(event));
  events_.clear();
  bytes_ = 0;
  if (const uint64_t lost = std::exchange(lost_, 0); lost > 0)
    all.push_back({{"kind", "lost"}, {"time_s", now_s()}, {"count", lost}});
  return all;
}

}  // namespace capsoc::service
