#include "ports/board_pins.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/console.h"
#include "kit/seconds.h"
#include "trace/picoseconds.h"

namespace capsoc::run {
namespace {

const sc_core::sc_time client_interval(1, sc_core::SC_MS);
constexpr unsigned user_leds = 2, all_leds = 10, button_count = 2;

/// What a digit of seven segments shows; segment a is bit 0, g is bit 6.
char digit(unsigned segments) {
  static constexpr uint8_t shapes[] = {0x3F, 0x06, 0x5B, 0x4F, 0x66, 0x6D, 0x7D, 0x07, 0x7F,
                                       0x6F, 0x77, 0x7C, 0x39, 0x5E, 0x79, 0x71, 0x40, 0x00};
  static constexpr char shown[] = "0123456789AbCdEF- ";
  for (std::size_t i = 0; i < std::size(shapes); ++i)
    if (shapes[i] == (segments & 0x7F)) return shown[i];
  return '?';
}

}  // namespace

TextField PinSettings::gpio(Settings& settings, unsigned number) {
  return TextField(
      settings,
      setting(fmt::format("gpio{}.backend", number), SettingKind::backend, "null",
              serial::pin_backend_names)
          .is_place()
          .by({fmt::format("--gpio{}", number), "file:PATH|tcp[:PORT]|pty[:LINK]|script:FILE",
               fmt::format("The pins of GPIO {}: lines with time, pin and level", number)}));
}

BoardPins::BoardPins(const sc_core::sc_module_name& name, soc::Soc& soc, serial::GiveUp give_up)
    : sc_module(name), soc_(soc), give_up_(std::move(give_up)) {
  SC_HAS_PROCESS(BoardPins);
  SC_METHOD(look);
  SC_METHOD(play);
}

std::optional<Error> BoardPins::add(const TextField& field, unsigned pins,
                                    std::function<void(unsigned, bool)> drive) {
  const std::string name = field.about().path.substr(0, field.about().path.find('.'));
  auto line = serial::PinLine::open(field(), name, pins, give_up_);
  if (!line) return Error{line.error()};
  if (const std::string place = line.value()->place(); !place.empty())
    host::say("{}: {}\n", name, place);
  ports_.push_back({std::move(line.value()), std::move(drive)});
  return std::nullopt;
}

std::optional<Error> BoardPins::open(const PinSettings& settings) {
  for (std::size_t n = 0; n < settings.gpios.size(); ++n) {
    if (settings.gpios[n]() == "null") continue;
    cmsdk::Gpio& gpio = *soc_.gpios()[n];
    const auto drive = [&gpio](unsigned pin, bool level) {
      const auto mask = static_cast<uint16_t>(1u << pin);
      gpio.drive(mask, level ? mask : 0);
    };
    if (auto error = add(settings.gpios[n], cmsdk::Gpio::pin_count, drive)) return error;
    listen_to_gpio(n);
  }
  if (settings.buttons() != "null") {
    const auto press = [this](unsigned button, bool pressed) {
      buttons_ = pressed ? buttons_ | 1u << button : buttons_ & ~(1u << button);
      soc_.fpgaio.set_buttons(buttons_);
    };
    if (auto error = add(settings.buttons, button_count, press)) return error;
  }
  terminal_ = settings.leds() == "terminal";
  digit_of_ = static_cast<int>(settings.seven_segment());
  if (settings.leds() == "null") return std::nullopt;
  if (!terminal_)
    if (auto error = add(settings.leds, all_leds, [](unsigned, bool) {})) return error;
  listen_to_leds();
  return std::nullopt;
}

void BoardPins::listen_to_gpio(std::size_t number) {
  serial::PinLine& line = *ports_.back().line;
  listening_.push_back(
      soc_.gpios()[number]->outputs.listen([&line](uint16_t levels, uint16_t driven) {
        line.changed(trace::picoseconds(sc_core::sc_time_stamp()), levels, driven);
      }));
}

void BoardPins::listen_to_leds() {
  serial::PinLine* const line = terminal_ ? nullptr : ports_.back().line.get();
  constexpr uint32_t all = (1u << all_leds) - 1, user = (1u << user_leds) - 1;
  if (line != nullptr) line->begin(all);
  const auto lit = [this, line](uint32_t leds) {
    leds_ = leds;
    if (line != nullptr)
      line->changed(trace::picoseconds(sc_core::sc_time_stamp()), leds_, all);
    else
      draw();
  };
  listening_.push_back(
      soc_.fpgaio.leds.listen([this, lit](uint32_t leds) { lit((leds_ & ~user) | leds); }));
  listening_.push_back(soc_.scc.leds.listen(
      [this, lit](uint32_t leds) { lit((leds_ & user) | (leds & 0xFF) << user_leds); }));
  if (!terminal_ || digit_of_ < 0) return;
  listening_.push_back(soc_.gpios()[static_cast<std::size_t>(digit_of_)]->outputs.listen(
      [this](uint16_t levels, uint16_t driven) {
        segments_ = levels & driven;
        draw();
      }));
}

/// Shows the pins in one line, which overwrites itself unless other output came in between.
void BoardPins::draw() {
  std::string text = fmt::format("[{:.6f} s]  LEDs ", kit::to_seconds(sc_core::sc_time_stamp()));
  for (unsigned led = 0; led < all_leds; ++led)
    text += fmt::format("{}{}", led == user_leds ? " " : "", (leds_ >> led & 1) != 0 ? '*' : '.');
  if (digit_of_ >= 0)
    text += fmt::format("  digit {}{}", digit(segments_), (segments_ & 0x80) != 0 ? "." : "");
  const std::string shown = text.substr(text.find(']'));
  if (shown == drawn_) return;
  drawn_ = shown;
  host::say("{}\n", text);
}

/// Runs while a client may have something to say.
void BoardPins::look() {
  flush();
  bool live = false;
  for (Port& port : ports_) {
    live = live || port.line->live();
    if (soc_.cpu.waits_for_resume()) continue;
    for (const serial::PinEvent& event : port.line->heard()) port.drive(event.pin, event.level);
  }
  if (live && give_up_()) return sc_core::sc_stop();
  if (live) next_trigger(client_interval);
}

/// Applies what the scripts say for this time. A restored board has this already.
void BoardPins::play() {
  const uint64_t now = trace::picoseconds(sc_core::sc_time_stamp());
  uint64_t next = UINT64_MAX;
  for (Port& port : ports_) {
    const auto& script = port.line->script();
    for (; port.done < script.size() && script[port.done].picoseconds <= now; ++port.done)
      if (!soc_.cpu.waits_for_resume()) port.drive(script[port.done].pin, script[port.done].level);
    if (port.done < script.size()) next = std::min(next, script[port.done].picoseconds);
  }
  if (next != UINT64_MAX)
    next_trigger(sc_core::sc_time(static_cast<double>(next - now), sc_core::SC_PS));
}

void BoardPins::flush() {
  for (const Port& port : ports_) port.line->flush();
}

void BoardPins::finish() {
  for (const Port& port : ports_) port.line->finish();
}

std::vector<std::string> BoardPins::failures() const {
  std::vector<std::string> sentences;
  for (const Port& port : ports_)
    if (const std::string text = port.line->failure(); !text.empty()) sentences.push_back(text);
  return sentences;
}

}  // namespace capsoc::run
