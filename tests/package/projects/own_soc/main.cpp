// A system-on-chip out of capsoc's parts: a Cortex-M3, a bus matrix, RAM and a UART, at addresses
// of our own choice.
#include <cstdio>
#include <cstring>
#include <systemc>

#include "armv7m/tlm/core_tlm.h"
#include "bus/ahb_matrix.h"
#include "bus/apb_bridge.h"
#include "bus/memory.h"
#include "cmsdk/uart.h"

namespace {

using capsoc::bus::BusKind;
using capsoc::bus::TargetKind;

capsoc::bus::AddressMap map() {
  return {{"ram", "ram", 0x00000000, 0x10000, TargetKind::memory},
          {"uart", "uart", 0x40002000, 0x1000, TargetKind::device, BusKind::apb}};
}

struct OwnSoc : sc_core::sc_module {
  capsoc::kit::ClockDomain clock{48'000'000};
  capsoc::armv7m::CoreTlm cpu{"cpu", clock};
  capsoc::bus::AhbMatrix ahb{"ahb", map(), clock};
  capsoc::bus::ApbBridge apb{"apb", map(), clock};
  capsoc::bus::Memory ram{"ram", 0x10000};
  capsoc::cmsdk::Uart uart{"uart", clock};

  explicit OwnSoc(const sc_core::sc_module_name& name) : sc_module(name) {
    cpu.icode.bind(ahb.i_code);
    cpu.dcode.bind(ahb.d_code);
    cpu.system.bind(ahb.system);
    ahb.port("ram")->bind(ram.socket);
    ahb.port(capsoc::bus::apb_bridge_target)->bind(apb.socket);
    apb.port("uart")->bind(uart.socket);
  }
};

/// Sends "ok\n", waiting for the buffer before each byte, and sleeps.
const uint16_t program[] = {
    0x4807,                  // 0x40: ldr r0, =0x40002000
    0x2120, 0x6101,          // movs r1, #32; str r1, [r0, #16]: the baud divider
    0x2101, 0x6081,          // movs r1, #1; str r1, [r0, #8]: the transmitter is on
    0xA206,                  // adr r2, text
    0x7813,                  // next: ldrb r3, [r2]
    0xB12B,                  // cbz r3, done
    0x6841, 0x07C9, 0xD1FC,  // full: ldr r1, [r0, #4]; lsls r1, #31; bne full
    0x6003, 0x3201,          // str r3, [r0]; adds r2, #1
    0xE7F7,                  // b next
    0xBF30, 0xE7FD,          // done: wfi; b done
    0x2000, 0x4000,          // 0x60
    0x6B6F, 0x000A,          // 0x64: "ok\n"
};

}  // namespace

int sc_main(int, char**) {
  OwnSoc soc("soc");
  const uint32_t vectors[] = {0x10000, 0x41};
  std::memcpy(soc.ram.data(), vectors, sizeof vectors);
  std::memcpy(soc.ram.data() + 0x40, program, sizeof program);
  const auto listening = soc.uart.transmitted.listen([](uint8_t byte) { std::putchar(byte); });
  sc_core::sc_start();  // returns when nothing can wake the processor any more
  std::printf("asleep: %d\n", soc.cpu.end_reason() == capsoc::armv7m::EndReason::asleep);
  return 0;
}
