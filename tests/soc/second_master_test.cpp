// A second master on the bus matrix writes code that the processor executes.
#include <gtest/gtest.h>
#include <tlm_utils/simple_initiator_socket.h>

#include <cstring>
#include <string>
#include <vector>

#include "../elsewhere.h"
#include "soc/soc.h"

namespace capsoc::soc {
namespace {

constexpr uint32_t function = 0x60;

/// Calls a function until it returns 2, which as it stands returns 1; then the vendor's end.
const std::vector<uint16_t> calling_program = {
    0xF000, 0xF80E,  // 0x40: bl 0x60
    0x2802,          // cmp r0, #2
    0xD1FB,          // bne 0x40
    0xBEAB,          // bkpt 0xAB
};

/// Writes at a time, like a DMA controller.
struct Writer : sc_core::sc_module {
  tlm_utils::simple_initiator_socket<Writer> socket{"socket"};
  bool granted = false;

  Writer(const sc_core::sc_module_name& name, uint64_t address, uint32_t value)
      : sc_module(name), address_(address), value_(value) {
    SC_HAS_PROCESS(Writer);
    SC_THREAD(write);
  }

 private:
  void write() {
    wait(sc_core::sc_time(1, sc_core::SC_MS));
    tlm::tlm_generic_payload payload;
    payload.set_write();
    payload.set_address(address_);
    payload.set_data_ptr(reinterpret_cast<unsigned char*>(&value_));
    payload.set_data_length(4);
    payload.set_streaming_width(4);
    sc_core::sc_time delay;
    socket->b_transport(payload, delay);
    tlm::tlm_dmi dmi;
    granted = payload.is_dmi_allowed() || socket->get_direct_mem_ptr(payload, dmi);
  }

  uint64_t address_;
  uint32_t value_;
};

constexpr uint32_t return_1 = 0x47702001, return_2 = 0x47702002;  // movs r0, #n; bx lr

void put_program(uint8_t* memory) {
  const uint32_t vectors[2] = {0x20001000, 0x41};
  std::memcpy(memory, vectors, sizeof vectors);
  std::memcpy(memory + 0x40, calling_program.data(), 2 * calling_program.size());
  std::memcpy(memory + function, &return_1, 4);
}

/// How the processor ended, and when.
std::string run(armv7m::CoreTlm& cpu, const Writer& writer) {
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  cpu.core().listeners().semihosting = [](armv7m::Core&) { return false; };
  sc_core::sc_start(sc_core::sc_time(2, sc_core::SC_MS));
  if (writer.granted) return "granted";
  if (cpu.end_reason() != armv7m::EndReason::exit) return "stale";
  const bool soon = sc_core::sc_time_stamp() < sc_core::sc_time(1001, sc_core::SC_US);
  return soon ? "new code" : "late";
}

TEST(SecondMaster, ReplacesCodeOfTheBoard) {
  for (const auto executor :
       {armv7m::Executor::stepping, armv7m::Executor::blocks, armv7m::Executor::translator})
    // An alias of the memory, too.
    for (const uint64_t alias : {0x0u, 0x400000u})
      EXPECT_EQ(test::elsewhere([&] {
                  Config config;
                  config.executor = executor;
                  Soc soc("soc", config);
                  Writer dma("dma", alias + function, return_2);
                  dma.socket.bind(soc.ahb.add_master("dma_port"));
                  put_program(soc.code_sram.data());
                  return run(soc.cpu, dma);
                }),
                "new code");
}

/// The matrix has no listener: direct memory is invalidated.
TEST(SecondMaster, ReplacesCodeOfASystemThatIsNotWiredForIt) {
  EXPECT_EQ(test::elsewhere([&] {
              kit::ClockDomain clock;
              const bus::MapEntry entry{"ram", "ram", 0, 0x10000, bus::TargetKind::memory};
              armv7m::CoreTlm cpu("cpu", clock);
              bus::AhbMatrix ahb("ahb", {entry}, clock);
              bus::Memory ram("ram", entry.size);
              cpu.icode.bind(ahb.i_code);
              cpu.dcode.bind(ahb.d_code);
              cpu.system.bind(ahb.system);
              ahb.port("ram")->bind(ram.socket);
              Writer dma("dma", function, return_2);
              dma.socket.bind(ahb.add_master("dma_port"));
              put_program(ram.data());
              return run(cpu, dma);
            }),
            "new code");
}

}  // namespace
}  // namespace capsoc::soc
