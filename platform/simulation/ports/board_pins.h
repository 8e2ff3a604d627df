// GPIO, LEDs and buttons connected to the host.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/setting_fields.h"
#include "serial/pin_line.h"
#include "soc/soc.h"

namespace capsoc::run {

struct PinSettings {
  static constexpr std::size_t ports = 4;
  static TextField gpio(Settings& settings, unsigned number);

  Settings& all;
  std::array<TextField, ports> gpios{{gpio(all, 0), gpio(all, 1), gpio(all, 2), gpio(all, 3)}};
  TextField buttons{
      all, setting("buttons.backend", SettingKind::backend, "null",
                   "who presses the two buttons: null, pty[:LINK], tcp[:PORT] or script:FILE")
               .is_place()
               .by({"--buttons", "tcp[:PORT]|pty[:LINK]|script:FILE",
                    "Who presses the two buttons: lines with a button and 1 or 0"})};
  TextField leds{all, setting("leds.backend", SettingKind::backend, "null",
                              "where changes of the LEDs go (0 and 1: the user's, 2 to 9: the "
                              "SCC's): terminal, null, file:PATH, pty[:LINK] or tcp[:PORT]")
                          .is_place()
                          .by({"--leds", "terminal|file:PATH|tcp[:PORT]|pty[:LINK]",
                               "Where changes of the LEDs go; terminal: a line on stderr"})};
  IntegerField seven_segment{
      all, setting("leds.seven_segment", SettingKind::integer, "-1",
                   "GPIO whose pins 0 to 7 are the segments a to g and the point of a digit in the "
                   "line of --leds terminal; -1: none")
               .in(-1, 3)
               .is_place()};
};

/// Nothing is looked at that no setting names.
class BoardPins : public sc_core::sc_module {
 public:
  BoardPins(const sc_core::sc_module_name& name, soc::Soc& soc, serial::GiveUp give_up);

  /// An Error is a wrong setting.
  std::optional<Error> open(const PinSettings& settings);
  void flush();
  void finish();
  /// A sentence for each place that lost what it should have kept.
  std::vector<std::string> failures() const;

 private:
  /// A line with what it does to the chip.
  struct Port {
    std::unique_ptr<serial::PinLine> line;
    std::function<void(unsigned pin, bool level)> drive;
    std::size_t done = 0;  ///< of its script
  };
  std::optional<Error> add(const TextField& field, unsigned pins,
                           std::function<void(unsigned, bool)> drive);
  void listen_to_gpio(std::size_t number);
  void listen_to_leds();
  void look();
  void play();
  void draw();

  soc::Soc& soc_;
  serial::GiveUp give_up_;
  std::vector<Port> ports_;
  std::vector<kit::Listening> listening_;
  bool terminal_ = false;
  int digit_of_ = -1;
  uint32_t leds_ = 0, buttons_ = 0;
  uint16_t segments_ = 0;
  std::string drawn_;
};

}  // namespace capsoc::run
