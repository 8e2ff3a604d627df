// The UARTs of the SoC connected to the host.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/setting_fields.h"
#include "serial/serial_line.h"
#include "serial/uart_script.h"
#include "soc/soc.h"

namespace capsoc::run {

struct UartSettings {
  struct Line {
    Line(Settings& settings, unsigned number);
    TextField backend, input, log;
  };
  Settings& all;
  std::array<Line, soc::Soc::uart_count> lines{{{all, 0}, {all, 1}, {all, 2}, {all, 3}, {all, 4}}};
  FlagField wait{all, setting("run.uart_wait", SettingKind::flag, "false",
                              "a UART's first byte waits until a client listens on its pty or tcp")
                          .is_place()
                          .by({"--uart-wait", "",
                               "Hold the first byte of a pty or tcp UART until a client listens",
                               SettingOption::Form::flag, "true"})};
  TextField until{
      all, setting("run.until_uart", SettingKind::text, "",
                   "a line of any UART that matches this regular expression ends the run with 0; "
                   "empty: none")
               .is_host_side()
               .by({"--until-uart", "REGEX", "End with 0 when a line of a UART matches"})};
  TextField fail{all,
                 setting("run.fail_uart", SettingKind::text, "", "the same with 1")
                     .is_host_side()
                     .by({"--fail-uart", "REGEX", "End with 1 when a line of a UART matches"})};
};

/// All lines, and the one place where bytes of the host enter the simulation. A byte is fetched
/// when the receiver is ready for it: as soon as the UART gets ready, or when a script has sent
/// bytes. While the host decides when bytes come, it is also asked once a simulated millisecond. A
/// look costs no simulated time.
class UartLines : public sc_core::sc_module {
 public:
  UartLines(const sc_core::sc_module_name& name, soc::Soc& soc, serial::GiveUp give_up);

  /// Opens what the settings name. An Error is a wrong setting; nothing was sent.
  std::optional<Error> open(const UartSettings& settings);

  /// Sets the callback that paces simulated time. Called once a simulated millisecond while the
  /// host decides when bytes come, before it is asked for them.
  void pace_by(std::function<void()> pace) { pace_ = std::move(pace); }

  /// Passes what the UARTs sent to the host, as far as the host takes it.
  void flush();
  /// At the end of the run: what is on the lines, too, and everything delivered.
  void finish();

  /// The line that ended the run by --until-uart or --fail-uart; null: none did.
  const serial::SerialLine* matched() const;
  /// The UART that --fail-uart ended the run for.
  std::optional<std::size_t> failed() const;
  const serial::SerialLine& line(std::size_t number) const { return *lines_[number]; }
  /// The byte that the receiver gets from the line, if there is one now.
  std::optional<uint8_t> next_input(std::size_t number);
  /// What a script expected and did not hear, a sentence; "" without. It ended the run.
  std::string missed() const;
  /// The first step of a script that is not done, a sentence; "" when all are.
  std::string unfinished() const;
  void visit(Archive& archive);

  /// A sentence for each place that lost bytes which it should have kept.
  std::vector<std::string> failures() const;

 private:
  void look();
  void play();
  std::optional<Error> open_line(std::size_t number, const UartSettings& settings,
                                 const serial::Patterns& patterns);
  void connect(std::size_t number);

  soc::Soc& soc_;
  serial::GiveUp give_up_;
  std::function<void()> pace_;  ///< empty: not paced
  std::array<std::unique_ptr<serial::SerialLine>, soc::Soc::uart_count> lines_;
  std::array<serial::UartScript, soc::Soc::uart_count> scripts_;
  sc_core::sc_event to_play_;
  std::array<kit::Listening, soc::Soc::uart_count> transmitted_;
  std::chrono::steady_clock::time_point looked_;
};

}  // namespace capsoc::run
