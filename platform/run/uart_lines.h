// The UARTs of the SoC connected to the host.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "serial/serial_line.h"
#include "soc/soc.h"
#include "support/settings.h"

namespace capsoc::run {

/// uart<n>.backend, .input, .log for every UART, and run.uart_wait, until_uart, fail_uart.
void add_uart_settings(Settings& settings);

/// Whether a setting says where a UART's bytes go to.
bool is_uart_place(const std::string& setting);

/// All lines, and the one place where bytes of the host enter the simulation: a byte is asked for
/// when the receiver is ready for it, by the UART itself as soon as it gets ready, and once a
/// simulated millisecond while the host decides when bytes come. Looking costs no simulated time.
class UartLines : public sc_core::sc_module {
 public:
  UartLines(const sc_core::sc_module_name& name, soc::Soc& soc, serial::GiveUp give_up);

  /// Opens what the settings name. An Error is a wrong setting; nothing was sent.
  std::optional<Error> open(const Settings& settings);

  /// What the UARTs sent is with the host, as far as the host takes it.
  void flush();
  /// At the end of the run: what is on the lines, too, and everything delivered.
  void finish();

  /// The line that ended the run by --until-uart or --fail-uart; null: none did.
  const serial::SerialLine* matched() const;
  const serial::SerialLine& line(std::size_t number) const { return *lines_[number]; }
  void visit(kit::Archive& archive);

  /// A sentence for each place that lost bytes which it should have kept.
  std::vector<std::string> failures() const;

 private:
  void look();
  void connect(std::size_t number);

  soc::Soc& soc_;
  serial::GiveUp give_up_;
  std::array<std::unique_ptr<serial::SerialLine>, soc::Soc::uart_count> lines_;
  std::chrono::steady_clock::time_point looked_;
};

}  // namespace capsoc::run
