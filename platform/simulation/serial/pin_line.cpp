#include "serial/pin_line.h"

#include <fmt/format.h>

#include <sstream>

#include "base/input_file.h"
#include "base/printable.h"
#include "serial/file_backend.h"
#include "serial/open_backend.h"
#include "serial/script_time.h"

namespace capsoc::serial {
namespace {

constexpr uint64_t largest_pin_script = 64U << 20U;
constexpr std::size_t longest_line = 200;

/// The words of a line without what is after #.
std::vector<std::string> words_of(const std::string& line) {
  std::istringstream text(line.substr(0, line.find('#')));
  std::vector<std::string> words;
  for (std::string word; words.size() < 4 && text >> word;) words.push_back(word);
  return words;
}

/// "3", "1": pin and level.
std::optional<PinEvent> event_of(const std::string& pin, const std::string& level, unsigned pins) {
  if (level != "0" && level != "1") return std::nullopt;
  if (pin.empty() || pin.size() > 2 || pin.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  const auto number = static_cast<unsigned>(std::stoul(pin));
  if (number >= pins) return std::nullopt;
  return PinEvent{0, number, level == "1"};
}

std::string in_seconds(uint64_t picoseconds) {
  constexpr uint64_t second = 1'000'000'000'000;
  return fmt::format("{}.{:09}", picoseconds / second, picoseconds % second / 1000);
}

}  // namespace

Result<std::vector<PinEvent>> parse_pin_script(const std::string& file, const std::string& text,
                                               unsigned pins) {
  std::vector<PinEvent> events;
  std::istringstream lines{std::string(without_byte_order_mark(text))};
  unsigned number = 0;
  const auto wrong = [&](const std::string& what) {
    return Error{fmt::format("{}:{}: {}", file, number, what)};
  };
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::vector<std::string> words = words_of(line);
    if (words.empty()) continue;
    const auto time = script_time(words[0]);
    const auto event = words.size() == 3 ? event_of(words[1], words[2], pins) : std::nullopt;
    if (!time || !event)
      return wrong(
          fmt::format("is no event; write TIME PIN LEVEL (0.5 3 1), the pin below {}, the "
                      "level 0 or 1",
                      pins));
    PinEvent timed = *event;
    timed.picoseconds = *time;
    if (!events.empty() && timed.picoseconds < events.back().picoseconds)
      return wrong("is earlier than the line before; write events in the order of time");
    events.push_back(timed);
  }
  return events;
}

Result<std::unique_ptr<PinLine>> PinLine::open(const std::string& spec, const std::string& name,
                                               unsigned pins, const GiveUp& give_up) {
  const std::string script = spec.rfind("script:", 0) == 0 ? spec.substr(7) : "";
  const bool known = spec == "null" || !script.empty() || spec.rfind("file:", 0) == 0 ||
                     spec.rfind("pty", 0) == 0 || spec.rfind("tcp", 0) == 0;
  if (!known)
    return Error{fmt::format("--{} {}: choose {}", name, printable(spec), pin_backend_names)};
  auto backend =
      open_backend(script.empty() ? spec : "null", "--" + name, give_up, pin_backend_names);
  if (!backend) return Error{backend.error()};
  std::unique_ptr<PinLine> line(new PinLine(name, pins, std::move(backend.value())));
  if (script.empty()) return line;
  const auto text =
      read_input(script, {fmt::format("name a script for --{}", name), largest_pin_script, true});
  if (!text) return Error{text.error()};
  auto events = parse_pin_script(script, text.value(), pins);
  if (!events) return Error{events.error()};
  line->script_ = std::move(events.value());
  return line;
}

void PinLine::changed(uint64_t picoseconds, uint32_t levels, uint32_t driven) {
  const uint32_t different = ((levels ^ levels_) & driven) | (driven ^ driven_);
  for (unsigned pin = 0; pin < pins_; ++pin) {
    if ((different >> pin & 1) == 0) continue;
    const char level = (driven >> pin & 1) == 0 ? 'z' : (levels >> pin & 1) != 0 ? '1' : '0';
    said_ += fmt::format("{} {} {}\n", in_seconds(picoseconds), pin, level);
  }
  levels_ = levels;
  driven_ = driven;
  if (said_.size() >= piece) flush();
}

std::vector<PinEvent> PinLine::heard() {
  incoming_ += backend_->read();
  std::vector<PinEvent> events;
  for (std::size_t end = 0; (end = incoming_.find('\n')) != std::string::npos;) {
    const std::vector<std::string> words = words_of(incoming_.substr(0, end));
    incoming_.erase(0, end + 1);
    if (words.empty()) continue;
    const auto event = words.size() == 2 ? event_of(words[0], words[1], pins_) : std::nullopt;
    if (event)
      events.push_back(*event);
    else
      backend_->write(fmt::format("# write PIN LEVEL (3 1), the pin below {}\n", pins_));
  }
  if (incoming_.size() > longest_line) incoming_.clear();
  return events;
}

void PinLine::flush() {
  if (said_.empty()) return;
  backend_->write(said_);
  said_.clear();
}

void PinLine::finish() {
  flush();
  backend_->finish();
}

}  // namespace capsoc::serial
