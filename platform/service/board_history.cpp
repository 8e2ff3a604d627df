// What a board has to do with its history.
#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>

#include "service/board.h"
#include "service/ticker.h"

namespace capsoc::service {

std::string Board::Snapshot::to_bytes() const {
  if (frames.empty()) return "";
  return service::to_bytes(Message{held, frames});
}

Board::Snapshot Board::Snapshot::of(const std::string& bytes) {
  MessageReader reader;
  reader.feed(bytes);
  auto incoming = reader.next();
  if (!incoming || !incoming->message) return {};
  return {std::move(incoming->message->body), std::move(incoming->message->frames)};
}

Position Board::position() const {
  const armv7m::Core& core = simulation_->soc().cpu.core();
  return {sc_core::sc_time_stamp().value(), core.cycles(), core.instructions(), sample_count()};
}

/// What comes from outside has to come through the session, and nothing may be written twice.
std::string Board::why_no_history() const {
  if (history_budget_ == 0) return "history_mb is 0";
  if (settings_.gdb.port() >= 0) return "gdb.port lets a debugger change the simulation";
  if (settings_.golden())
    return settings_.golden.about().path + " needs all samples, which no snapshot has";
  for (const Setting& setting : settings_.all()) {
    if (setting.value.empty()) continue;
    if (setting.kind == SettingKind::output || setting.kind == SettingKind::directory)
      return fmt::format("{} names a place that going back would write to again", setting.path);
    // Standard streams are the session's own.
    static const std::set<std::string> own = {"null", "stdout", "stdio", "stderr"};
    if (setting.kind == SettingKind::backend && own.count(setting.value) == 0 &&
        setting.value.rfind("script:", 0) != 0)
      return fmt::format("{} connects the simulation to {}", setting.path, setting.value);
  }
  return "";
}

/// A library of the user may hold what a fork shares, and perf_map names a file by the process.
bool Board::may_be_forked() const {
  return no_history_.empty() && settings_.coprocessor.rtl_library.empty() &&
         !settings_.trace.perf_map();
}

void Board::begin_history(const Snapshot& from) {
  no_history_ = why_no_history();
  if (!no_history_.empty()) return;
  history_ = History(history_budget_);
  history_.begin(position(), from.to_bytes());
  ticker_ = std::make_unique<Ticker>(*simulation_);
  effort_begin_ns_ = 0 - processor_time_ns();
  tick(true);
}

void Board::continue_history(History history, std::size_t snapshot) {
  history_ = std::move(history);
  history_.stand_at(snapshot);
  ticker_ = std::make_unique<Ticker>(*simulation_);
  effort_begin_ns_ = history_.snapshots()[snapshot].effort_ns - processor_time_ns();
  tick(true);
}

uint64_t Board::effort_ns() const {
  return effort_begin_ns_ + processor_time_ns();
}

void Board::tick(bool on) {
  if (ticker_ != nullptr) ticker_->set(on);
}

/// Not on a way that was gone before, nor twice at one position: its snapshots are there.
void Board::remember() {
  if (ticker_ == nullptr || !ticker_->take() || is_finished()) return;
  const Position now = position();
  if (now < history_.reached() || now == history_.snapshots().back().at) return;
  const uint64_t begin = processor_time_ns();
  keep();
  ticker_->took(processor_time_ns() - begin);
}

std::optional<Error> Board::keep() {
  const auto state = snapshot(false);
  if (!state) return Error{state.error()};
  history_.add_snapshot(position(), effort_ns(), state.value().to_bytes());
  return std::nullopt;
}

Json Board::told(Frames& frames) {
  Answer answer;
  answer.frames = std::move(frames);
  Json known = Json::object();
  for (const auto& [name, output] : outputs()) {
    serial::KeptStream::Told told = output->told();
    Json each = {{"told", told.told}, {"lost", told.lost}};
    answer.add_bytes(each, "said", std::move(told.said));
    known[name] = std::move(each);
  }
  frames = std::move(answer.frames);
  return {{"outputs", std::move(known)},
          {"events", events_.subscribed()},
          {"events_ps", events_.told().value()},
          {"activity", activity_.is_on() ? Json(activity_.window()) : Json()}};
}

std::optional<Error> Board::set_told(const Json& told, const Frames& frames) {
  if (const auto known = told.find("outputs"); known != told.end()) {
    for (const auto& [name, output] : outputs()) {
      const Json& each = known->at(name);
      output->set_told({each.at("told").get<uint64_t>(), bytes_in(each.at("said"), frames),
                        each.at("lost").get<uint64_t>()});
    }
    events_.set_told(sc_core::sc_time::from_value(told.at("events_ps").get<uint64_t>()));
  } else {
    forget_told();
  }
  for (UartTap& uart : uarts_) uart.search_what_is_sent_again();
  // Which samples of the way here are there depends on where a snapshot was: only the newest is.
  if (samples_.size() > 1) {
    first_sample_ += samples_.size() - 1;
    samples_.erase(samples_.begin(), samples_.end() - 1);
  }
  return subscribe(told.at("events").get<std::vector<std::string>>());
}

void Board::mute() {
  for (const auto& each : outputs()) each.second->mute();
}

void Board::forget_told() {
  for (const auto& each : outputs()) each.second->forget_told();
  events_.set_told(sc_core::SC_ZERO_TIME);
}

}  // namespace capsoc::service
