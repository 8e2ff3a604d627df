// A small SoC around the buses: every test of this program shares it, since SystemC elaborates
// once.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "bus/ahb_matrix.h"
#include "bus/apb_bridge.h"
#include "bus/memory.h"
#include "bus/unimplemented.h"
#include "initiator.h"
#include "kit/clock_domain.h"
#include "kit/protocol_monitor.h"

namespace capsoc::test {

/// An APB device that writes down what arrives and answers as told.
class Probe : public sc_core::sc_module {
 public:
  struct Transfer {
    tlm::tlm_command command;
    uint64_t address;
    unsigned length;
    uint32_t data;
    uint32_t strobes;  // bit a lane
  };
  tlm_utils::simple_target_socket<Probe> socket{"socket"};
  std::vector<Transfer> transfers;
  uint32_t read_value = 0;
  uint32_t debug_value = 0;
  tlm::tlm_response_status response = tlm::TLM_OK_RESPONSE;
  sc_core::sc_time ready_after;
  bool takes_early = false;

  explicit Probe(sc_core::sc_module_name name);
  void forget();

 private:
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);
  unsigned transport_dbg(tlm::tlm_generic_payload& payload);
};

struct Bench {
  Bench();
  /// Before a test. The monitors have seen nothing wrong of matrix, bridge and memories in those
  /// before it; what an initiator does wrong is the test's.
  void forget();
  sc_core::sc_time cycles(uint64_t n) const { return clock.time_of(n) - clock.time_of(0); }

  kit::ClockDomain clock;  // 25 MHz: 40 ns a cycle
  bus::AhbMatrix matrix;
  bus::ApbBridge bridge;
  bus::Memory ram, slow_ram, small_ram;
  Probe probe, sluggish;
  bus::Unimplemented absent;
  Initiator fetch, load, system, dma, video;
  uint32_t pc = 0x1234;
  kit::ProtocolWatch watch;
  std::string faults, initiators_faults;  // a line each

 private:
  template <typename From, typename To>
  void connect(From& initiator, To& target, kit::Downstream downstream);
  std::deque<kit::ProtocolMonitor<>> monitors_;
  kit::Listening listening_;
};

/// The one of this program.
Bench& bench();

namespace at {
constexpr uint64_t ram = 0x20000000;        // 4 KiB
constexpr uint64_t ram_alias = 0x20001000;  // its upper 2 KiB
constexpr uint64_t slow_ram = 0x21000000;   // 4 KiB, 3 wait states
constexpr uint64_t small_ram = 0x01000000;  // 1 KiB repeated 4 times
constexpr uint64_t probe = 0x40000000;      // APB
constexpr uint64_t sluggish = 0x40001000;   // APB, 5 wait states
constexpr uint64_t apb_hole = 0x40003000;
constexpr uint64_t absent = 0x50000000;
constexpr uint64_t nothing = 0x60000000;
}  // namespace at

}  // namespace capsoc::test
