// The host interfaces of a run: UARTs, semihosting, ITM and the debugger.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/setting_fields.h"
#include "debug/gdb_server.h"
#include "ports/board_pins.h"
#include "ports/itm_output.h"
#include "ports/port_settings.h"
#include "ports/semihosting_port.h"
#include "ports/uart_lines.h"
#include "serial/kept_stream.h"
#include "soc/soc.h"

namespace capsoc::run {

/// The settings of all ports.
struct PortSettings {
  const UartSettings& uarts;
  const PinSettings& pins;
  const SemihostingSettings& semihosting;
  const ItmSettings& itm;
  const GdbSettings& gdb;
  serial::KeptStreams* kept = nullptr;  ///< instead of standard streams, which must outlive them
};

class HostPorts {
 public:
  /// Opens what the settings ask for. `give_up` ends any wait for the host. An Error is a wrong
  /// setting.
  static Result<std::unique_ptr<HostPorts>> open(const PortSettings& settings, soc::Soc& soc,
                                                 const loader::ElfImage& program,
                                                 const std::string& program_file,
                                                 const serial::GiveUp& give_up);

  /// Delivers all output after the simulation. Returns a sentence for each output that lost bytes.
  std::vector<std::string> finish();
  /// Sends the exit code to the debuggers.
  void tell_debugger(int code);

  void visit(Archive& archive);
  /// Sets the function that saves the state when a debugger asks for it.
  void on_save(debug::SocTarget::Saver saver) {
    if (gdb_ != nullptr) gdb_->on_save(std::move(saver));
  }
  /// Sets a callback that runs before the host is asked for bytes, and paces the run (RealTime).
  void pace_by(std::function<void()> pace) { uarts_.pace_by(std::move(pace)); }
  /// Call when a restored simulation begins.
  void restored() { semihosting_->restored(); }

  const UartLines& uarts() const { return uarts_; }
  /// The byte that the receiver of a UART gets from its line, if there is one now.
  std::optional<uint8_t> next_uart_input(std::size_t number) { return uarts_.next_input(number); }
  int exit_status() const { return semihosting_->exit_status(); }

 private:
  HostPorts(soc::Soc& soc, const serial::GiveUp& give_up)
      : uarts_("uart_lines", soc, give_up), pins_("board_pins", soc, give_up) {}

  UartLines uarts_;
  BoardPins pins_;
  std::unique_ptr<ItmOutput> itm_;
  std::unique_ptr<SemihostingPort> semihosting_;
  std::unique_ptr<debug::GdbServer> gdb_;  // null without
};

}  // namespace capsoc::run
