// The system-on-chip put together: processor, buses, memories, peripherals, coprocessor, sensor
// input.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <systemc>
#include <vector>

#include "an385/fpga_io.h"
#include "an385/scc.h"
#include "armv7m/tlm/core_tlm.h"
#include "base/result.h"
#include "bus/address_map.h"
#include "bus/ahb_matrix.h"
#include "bus/apb_bridge.h"
#include "bus/memory.h"
#include "bus/unimplemented.h"
#include "cmsdk/dual_timer.h"
#include "cmsdk/gpio.h"
#include "cmsdk/timer.h"
#include "cmsdk/uart.h"
#include "cmsdk/watchdog.h"
#include "coprocessor/tlm/coprocessor_tlm.h"
#include "coprocessor/types.h"
#include "kit/clock_domain.h"
#include "kit/probe.h"
#include "kit/protocol_monitor.h"
#include "kit/register_target.h"
#include "peripherals/adc_front_end.h"
#include "peripherals/clock_controller.h"
#include "soc/board_map.h"

namespace capsoc::soc {

class Soc;

/// A device of the user's own in a slot that the board leaves free (docs/developer/extending.md).
struct OwnDevice {
  std::string slot;  ///< name of an unimplemented entry of the address map, "reserved_apb_3"
  /// Called while the SoC is built. Interrupts go to soc.cpu.set_interrupt().
  std::function<std::unique_ptr<kit::RegisterTarget>(Soc& soc)> make;
};

/// What can be chosen when the SoC is built.
struct Config {
  coprocessor::Options coprocessor;
  /// What stands at the coprocessor's bus target; empty: the model with `coprocessor`.
  std::function<std::unique_ptr<coprocessor::Device>()> make_coprocessor;
  sc_core::sc_time quantum{1, sc_core::SC_MS};
  const armv7m::Profile* processor = &armv7m::cortex_m3;
  armv7m::Executor executor = armv7m::Executor::translator;
  armv7m::TranslatorLimits translator;
  bool fast_forward = true;  ///< CoreTlm::set_fast_forward
  MemoryWaits memory_waits;
  std::vector<OwnDevice> devices;
  bool monitor = false;  ///< a kit::ProtocolMonitor between every two sockets
};

/// Arm MPS2 AN385 with the self-calibration coprocessor. The address map is data
/// (soc/board_map.h).
class Soc : public sc_core::sc_module {
 public:
  Soc(const sc_core::sc_module_name& name, const Config& config);

  /// Copies a segment of a program into memory. An Error names it, and the program's file `path`,
  /// where it lies outside. One without bytes lies nowhere: nothing is done.
  std::optional<Error> load(const std::string& path, uint32_t address,
                            const std::vector<uint8_t>& bytes);

  /// Every part of the board, in the order in which state is saved: the clock's users after it.
  const std::vector<kit::Component*>& components() const { return components_; }

  /// Everything back to its reset state, memories excepted; time continues.
  void reset_peripherals();

  /// What is between the parts: the clock, and interrupt lines that several drive.
  void visit(Archive& archive);

  /// Every interrupt output with the name of its device, and how the address map wires it.
  using EachInterrupt =
      std::function<void(kit::InterruptLine&, const char* device, const bus::InterruptWire& wire)>;
  void each_interrupt(const EachInterrupt& call);

  /// Bytes of one memory, without side effects or time; false, with nothing done, for any other
  /// place.
  bool read_memory(uint32_t address, void* bytes, uint32_t size);
  bool write_memory(uint32_t address, const void* bytes, uint32_t size);

  /// Nothing outside the processor will interrupt it where only NMI or a reset can.
  bool watchdog_is_off() const { return !watchdog.CONTROL.any(cmsdk::Watchdog::control_interrupt); }

  /// A word as a debugger reads it, without side effects; 0 where nothing answers.
  uint32_t peek(uint32_t address);

  kit::ClockDomain clock;
  armv7m::CoreTlm cpu;
  bus::AhbMatrix ahb;
  bus::ApbBridge apb;
  bus::Memory code_sram, data_sram, block_ram, psram;
  cmsdk::Timer timer0, timer1;
  cmsdk::DualTimer dual_timer;
  cmsdk::Watchdog watchdog;
  cmsdk::Uart uart0, uart1, uart2, uart3, uart4;
  cmsdk::Gpio gpio0, gpio1, gpio2, gpio3;
  an385::FpgaIo fpgaio;
  an385::Scc scc;
  coprocessor::CoprocessorTlm coprocessor;
  peripherals::AdcFrontEnd adc;
  peripherals::ClockController clock_controller;
  std::vector<std::unique_ptr<bus::Unimplemented>> unimplemented;
  std::vector<std::unique_ptr<kit::RegisterTarget>> devices;  ///< Config::devices
  kit::ProtocolWatch protocol;                                ///< Config::monitor

  static constexpr std::size_t uart_count = 5;
  /// Every UART and every GPIO, in the order of their numbers.
  std::array<cmsdk::Uart*, uart_count> uarts() { return {&uart0, &uart1, &uart2, &uart3, &uart4}; }
  std::array<cmsdk::Gpio*, 4> gpios() { return {&gpio0, &gpio1, &gpio2, &gpio3}; }

 private:
  /// Outputs that share a processor line are ORed (the UART overrun outputs of the AN385).
  std::array<int, armv7m::Core::interrupt_count> high_sources_{};
  std::vector<kit::Component*> components_;
  kit::Listening replaced_;
  bool monitor_;
  std::vector<std::unique_ptr<kit::ProtocolMonitor<>>> monitors_;

  void list_components();
  void bind();
  void make_others(const std::vector<OwnDevice>& own);
  template <typename Initiator, typename Target>
  void connect(Initiator& initiator, Target& target, const std::string& name,
               kit::Downstream downstream);
  template <typename Socket>
  void bind_target(const bus::MapEntry& entry, Socket& socket);
  /// Every interrupt output that the address map wires.
  void connect_interrupts();
  bool is_memory(uint32_t address, uint32_t size) const;
  uint32_t access_memory(tlm::tlm_command command, uint32_t address, void* bytes, uint32_t size);
};

}  // namespace capsoc::soc
