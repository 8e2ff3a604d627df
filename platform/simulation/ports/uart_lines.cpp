#include "ports/uart_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "host/console.h"
#include "serial/open_backend.h"
#include "trace/picoseconds.h"

namespace capsoc::run {
namespace {

const sc_core::sc_time look_interval(1, sc_core::SC_MS);
constexpr std::chrono::microseconds shortest_look{200};  // asking the host costs a system call
constexpr std::chrono::milliseconds idle_nap{1};

}  // namespace

UartSettings::Line::Line(Settings& settings, unsigned number)
    : backend(settings,
              setting(fmt::format("uart{}.backend", number), SettingKind::backend,
                      number == 0 ? "stdout" : "null", serial::uart_backend_names)
                  .is_place()
                  .by({fmt::format("--uart{}", number),
                       "stdout|stdio|null|file:PATH|pty[:LINK]|tcp[:PORT]|script:FILE",
                       fmt::format("Where UART {} goes; stdio reads stdin, too", number)})),
      input(settings,
            setting(fmt::format("uart{}.input", number), SettingKind::input, "",
                    "bytes for the receiver from this file instead of the backend; empty: the "
                    "backend's")),
      log(settings, setting(fmt::format("uart{}.log", number), SettingKind::output, "",
                            "copy of what it sends; empty: none")
                        .is_place()) {}

UartLines::UartLines(const sc_core::sc_module_name& name, soc::Soc& soc, serial::GiveUp give_up)
    : sc_module(name), soc_(soc), give_up_(std::move(give_up)) {
  SC_HAS_PROCESS(UartLines);
  SC_METHOD(look);
  SC_METHOD(play);
  sensitive << to_play_;
}

std::optional<Error> UartLines::open(const UartSettings& settings) {
  auto patterns = serial::Patterns::make(settings.until(), settings.fail());
  if (!patterns) return Error{patterns.error()};
  for (std::size_t n = 0; n < lines_.size(); ++n)
    for (std::size_t m = 0; m < n; ++m)
      if (const std::string& spec = settings.lines[n].backend();
          serial::are_the_same_place(spec, settings.lines[m].backend()))
        return Error{fmt::format("--uart{} {}: is taken by uart{}; name another one", n, spec, m)};
  for (std::size_t n = 0; n < lines_.size(); ++n)
    if (auto error = open_line(n, settings, patterns.value())) return error;
  for (const auto& line : lines_)
    if (const std::string place = line->backend().place(); !place.empty())
      host::say("{}: {}\n", line->name(), place);
  return std::nullopt;
}

std::optional<Error> UartLines::open_line(std::size_t number, const UartSettings& settings,
                                          const serial::Patterns& patterns) {
  const UartSettings::Line& asked = settings.lines[number];
  const std::string name = fmt::format("uart{}", number);
  std::string backend = asked.backend();
  if (const std::string prefix = "script:";
      backend.rfind(prefix, 0) == 0 && backend.size() > prefix.size()) {
    if (!asked.input.empty())
      return Error{fmt::format("{}: the script sends already; leave one of the two out",
                               asked.input.about().path)};
    auto script = serial::UartScript::open(backend.substr(prefix.size()), "--" + name);
    if (!script) return Error{script.error()};
    scripts_[number] = std::move(script.value());
    backend = "null";
  }
  auto line = serial::SerialLine::open(
      {name, backend, asked.input(), asked.log(), settings.wait(), patterns}, give_up_);
  if (!line) return Error{line.error()};
  lines_[number] = std::move(line.value());
  connect(number);
  return std::nullopt;
}

void UartLines::connect(std::size_t number) {
  cmsdk::Uart& uart = *soc_.uarts()[number];
  serial::SerialLine& line = *lines_[number];
  serial::UartScript& script = scripts_[number];
  transmitted_[number] = uart.transmitted.listen([this, &uart, &line, &script](uint8_t byte) {
    const bool dry = uart.transmitter_idle();
    line.transmitted(byte, dry);
    if (script.sent(byte, dry)) to_play_.notify(sc_core::SC_ZERO_TIME);
  });
  uart.set_source([this, number] { return next_input(number); });
  line.on_match([] {
    if (sc_core::sc_is_running()) sc_core::sc_stop();  // not for what is flushed at the end
  });
}

/// Runs while the host may have something to say; then it is what keeps a sleeping board alive.
void UartLines::look() {
  flush();
  if (pace_) pace_();
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ >= shortest_look) {
    looked_ = now;
    // The receivers of a board that waits for its state are not themselves yet.
    if (!soc_.cpu.waits_for_resume())
      for (cmsdk::Uart* uart : soc_.uarts()) uart->look_for_input();
    // With nothing else to do, simulated time need not race.
    if (!pace_ && !sc_core::sc_pending_activity()) std::this_thread::sleep_for(idle_nap);
    if (give_up_()) return sc_core::sc_stop();
  }
  if (std::any_of(lines_.begin(), lines_.end(), [](const auto& line) { return line->live(); }))
    next_trigger(look_interval);
}

std::optional<uint8_t> UartLines::next_input(std::size_t number) {
  if (const auto byte = scripts_[number].next_input()) return byte;
  return lines_[number]->next_input();
}

/// What the scripts do at this instant; a board that waits for its state has them play from there.
void UartLines::play() {
  if (soc_.cpu.waits_for_resume()) return;
  const uint64_t now = trace::picoseconds(sc_core::sc_time_stamp());
  uint64_t next = UINT64_MAX;
  for (std::size_t n = 0; n < scripts_.size(); ++n) {
    serial::UartScript& script = scripts_[n];
    script.play(now);
    if (script.has_input()) soc_.uarts()[n]->look_for_input();
    if (!script.failure().empty()) return sc_core::sc_stop();
    next = std::min(next, script.next_time().value_or(UINT64_MAX));
  }
  to_play_.cancel();
  if (next != UINT64_MAX)
    to_play_.notify(sc_core::sc_time(static_cast<double>(next - now), sc_core::SC_PS));
}

std::string UartLines::missed() const {
  for (std::size_t n = 0; n < scripts_.size(); ++n)
    if (const std::string& why = scripts_[n].failure(); !why.empty())
      return fmt::format("uart{}: {}", n, why);
  return "";
}

std::string UartLines::unfinished() const {
  for (std::size_t n = 0; n < scripts_.size(); ++n)
    if (const std::string step = scripts_[n].unfinished(); !step.empty())
      return fmt::format("uart{}: {}", n, step);
  return "";
}

void UartLines::flush() {
  for (const auto& line : lines_) line->flush();
}

void UartLines::finish() {
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    soc_.uarts()[n]->flush();
    lines_[n]->finish();
  }
}

const serial::SerialLine* UartLines::matched() const {
  const serial::SerialLine* found = nullptr;
  for (const auto& line : lines_)
    if (line->match() && (found == nullptr || line->match()->failed)) found = line.get();
  return found;
}

std::optional<std::size_t> UartLines::failed() const {
  for (std::size_t n = 0; n < lines_.size(); ++n)
    if (const auto& match = lines_[n]->match(); match && match->failed) return n;
  return std::nullopt;
}

std::vector<std::string> UartLines::failures() const {
  std::vector<std::string> sentences;
  for (const auto& line : lines_)
    for (std::string& text : line->failures()) sentences.push_back(std::move(text));
  return sentences;
}

void UartLines::visit(Archive& archive) {
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    archive(lines_[n]->name().c_str(), *lines_[n]);
    archive(fmt::format("script{}", n).c_str(), scripts_[n]);
  }
  if (archive.loading()) to_play_.notify(sc_core::SC_ZERO_TIME);
}

}  // namespace capsoc::run
