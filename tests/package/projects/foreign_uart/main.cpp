// capsoc's Cortex-M3 alone, on a bus, a memory and a UART that know nothing of capsoc.
#include <tlm_utils/multi_passthrough_target_socket.h>
#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <cstdio>
#include <cstring>
#include <systemc>
#include <vector>

#include "armv7m/tlm/core_tlm.h"

namespace {

struct Uart : sc_core::sc_module {
  tlm_utils::simple_target_socket<Uart> socket{"socket"};

  explicit Uart(const sc_core::sc_module_name& name) : sc_module(name) {
    socket.register_b_transport(this, &Uart::b_transport);
  }
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    if (payload.is_write())
      std::putchar(*payload.get_data_ptr());
    else
      std::memset(payload.get_data_ptr(), 0, payload.get_data_length());
    wait(delay + sc_core::sc_time(1, sc_core::SC_US));  // the line is slow
    delay = sc_core::SC_ZERO_TIME;
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
  }
};

struct Ram : sc_core::sc_module {
  tlm_utils::simple_target_socket<Ram> socket{"socket"};
  std::vector<unsigned char> bytes = std::vector<unsigned char>(0x10000);

  explicit Ram(const sc_core::sc_module_name& name) : sc_module(name) {
    socket.register_b_transport(this, &Ram::b_transport);
    socket.register_get_direct_mem_ptr(this, &Ram::get_direct_mem_ptr);
  }
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time&) {
    unsigned char* const place = &bytes[payload.get_address() % bytes.size()];
    if (payload.is_read())
      std::memcpy(payload.get_data_ptr(), place, payload.get_data_length());
    else
      std::memcpy(place, payload.get_data_ptr(), payload.get_data_length());
    payload.set_dmi_allowed(true);
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
  }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload&, tlm::tlm_dmi& dmi) {
    dmi.allow_read_write();
    dmi.set_dmi_ptr(bytes.data());
    dmi.set_start_address(0);
    dmi.set_end_address(bytes.size() - 1);
    return true;
  }
};

struct Bus : sc_core::sc_module {
  tlm_utils::multi_passthrough_target_socket<Bus> masters{"masters"};
  tlm_utils::simple_initiator_socket<Bus> ram{"ram"}, uart{"uart"};

  explicit Bus(const sc_core::sc_module_name& name) : sc_module(name) {
    masters.register_b_transport(this, &Bus::b_transport);
    masters.register_get_direct_mem_ptr(this, &Bus::get_direct_mem_ptr);
  }
  void b_transport(int, tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    (payload.get_address() < 0x40000000 ? ram : uart)->b_transport(payload, delay);
  }
  bool get_direct_mem_ptr(int, tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi) {
    return payload.get_address() < 0x40000000 && ram->get_direct_mem_ptr(payload, dmi);
  }
};

/// Sends ten digits, and ends by a semihosting call.
const uint16_t program[] = {
    0x2040, 0x0600,  // 0x40: movs r0, #0x40; lsls r0, #24
    0x2130,          // movs r1, #'0'
    0x6001, 0x3101,  // next: str r1, [r0]; adds r1, #1
    0x293A, 0xD1FB,  // cmp r1, #'9' + 1; bne next
    0x210A, 0x6001,  // movs r1, #'\n'; str r1, [r0]
    0xBEAB,          // bkpt 0xAB
};

}  // namespace

int sc_main(int, char**) {
  capsoc::kit::ClockDomain clock{100'000'000};
  capsoc::armv7m::CoreTlm cpu("cpu", clock);
  Bus bus("bus");
  Ram ram("ram");
  Uart uart("uart");
  for (auto* port : {&cpu.icode, &cpu.dcode, &cpu.system}) port->bind(bus.masters);
  bus.ram.bind(ram.socket);
  bus.uart.bind(uart.socket);
  const uint32_t vectors[] = {0x10000, 0x41};
  std::memcpy(ram.bytes.data(), vectors, sizeof vectors);
  std::memcpy(ram.bytes.data() + 0x40, program, sizeof program);
  cpu.core().listeners().semihosting = [](capsoc::armv7m::Core&) { return false; };
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  sc_core::sc_start();
  std::printf("instructions: %llu, microseconds: %d\n",
              static_cast<unsigned long long>(cpu.core().instructions()),
              static_cast<int>(sc_core::sc_time_stamp().to_seconds() * 1e6));
  return 0;
}
