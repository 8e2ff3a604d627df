// capsoc's coprocessor on capsoc's bus, driven by an initiator that knows nothing of capsoc.
#include <tlm_utils/simple_initiator_socket.h>

#include <cmath>
#include <cstdio>
#include <systemc>

#include "bus/ahb_matrix.h"
#include "bus/apb_bridge.h"
#include "capsoc_registers.h"
#include "coprocessor/tlm/coprocessor_tlm.h"

namespace {

namespace registers = capsoc::registers::coprocessor;

struct Initiator : sc_core::sc_module {
  tlm_utils::simple_initiator_socket<Initiator> socket{"socket"};
  // The other two buses of a Cortex-M3, which the matrix has and this initiator does not use.
  tlm_utils::simple_initiator_socket<Initiator> no_icode{"no_icode"}, no_dcode{"no_dcode"};

  explicit Initiator(const sc_core::sc_module_name& name) : sc_module(name) {
    SC_HAS_PROCESS(Initiator);
    SC_THREAD(run);
  }

 private:
  void access(tlm::tlm_command command, uint32_t offset, uint32_t& value) {
    tlm::tlm_generic_payload payload;
    payload.set_command(command);
    payload.set_address(registers::base_address + offset);
    payload.set_data_ptr(reinterpret_cast<unsigned char*>(&value));
    payload.set_data_length(4);
    payload.set_streaming_width(4);
    sc_core::sc_time delay;
    socket->b_transport(payload, delay);
    wait(delay);
    if (payload.is_response_error()) std::printf("%s\n", payload.get_response_string().c_str());
  }
  uint32_t read(uint32_t offset) {
    uint32_t value = 0;
    access(tlm::TLM_READ_COMMAND, offset, value);
    return value;
  }
  void write(uint32_t offset, uint32_t value) { access(tlm::TLM_WRITE_COMMAND, offset, value); }

  void run() {
    const double radians = std::acos(-1.0) / 6;
    std::printf("ID: %08x\n", read(registers::ID_offset));
    write(registers::CTRL_offset, registers::CTRL_CALIB_mask);
    write(registers::SOFT_U_offset, static_cast<uint32_t>(0x1p30 * std::sin(radians)));
    write(registers::SOFT_V_offset, static_cast<uint32_t>(0x1p30 * std::cos(radians)));
    while ((read(registers::STATUS_offset) & registers::STATUS_BUSY_mask) != 0) {
    }
    std::printf("angle: %.4f degrees\n", read(registers::ANGLE_offset) * 360.0 / 0x1p32);
  }
};

capsoc::bus::AddressMap map() {
  using capsoc::bus::BusKind;
  using capsoc::bus::TargetKind;
  return {{"coprocessor", "coprocessor", registers::base_address, registers::block_size,
           TargetKind::device, BusKind::apb}};
}

}  // namespace

int sc_main(int, char**) {
  capsoc::kit::ClockDomain clock{25'000'000};
  capsoc::bus::AhbMatrix ahb("ahb", map(), clock);
  capsoc::bus::ApbBridge apb("apb", map(), clock);
  capsoc::coprocessor::CoprocessorTlm coprocessor("coprocessor", clock);
  Initiator initiator("initiator");
  initiator.socket.bind(ahb.system);
  initiator.no_icode.bind(ahb.i_code);
  initiator.no_dcode.bind(ahb.d_code);
  ahb.port(capsoc::bus::apb_bridge_target)->bind(apb.socket);
  apb.port("coprocessor")->bind(coprocessor.socket);
  sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_MS));
  return 0;
}
