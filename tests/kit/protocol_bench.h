// An initiator, an interconnect and a target, with a monitor on either side of the interconnect.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <systemc>
#include <tlm>

#include "kit/protocol_monitor.h"
#include "kit/protocol_watch.h"

namespace capsoc::test {

using Payload = tlm::tlm_generic_payload;
using Sync = tlm::tlm_sync_enum;
using NbTransport =
    std::function<Sync(Payload& payload, tlm::tlm_phase& phase, sc_core::sc_time& delay)>;

constexpr uint64_t target_base = 0x1000;  // of the target's addresses, at the initiator
constexpr uint64_t target_size = 0x1000;

/// As an initiator begins it: a legal request until a test changes it.
struct Request {
  explicit Request(tlm::tlm_command command = tlm::TLM_READ_COMMAND, unsigned length = 4) {
    renew(command, length);
  }
  void renew(tlm::tlm_command command, unsigned length) {
    payload.set_command(command);
    payload.set_address(target_base + 0x10);
    payload.set_data_ptr(bytes);
    payload.set_data_length(length);
    payload.set_streaming_width(length);
    payload.set_byte_enable_ptr(nullptr);
    payload.set_byte_enable_length(0);
    payload.set_dmi_allowed(false);
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  }
  void use_enables(unsigned length) {
    payload.set_byte_enable_ptr(enables);
    payload.set_byte_enable_length(length);
  }
  Payload payload;
  unsigned char bytes[16] = {};
  unsigned char enables[16] = {0xff, 0, 0xff, 0};
};

/// With a memory manager and a reference, as nb_transport wants it.
struct ManagedRequest : Request, private tlm::tlm_mm_interface {
  using Request::Request;
  void manage() {
    payload.set_mm(this);
    payload.acquire();
  }
  ~ManagedRequest() override {
    payload.reset();
    payload.set_mm(nullptr);
  }

 private:
  void free(Payload*) override {}
};

struct TestInitiator : sc_core::sc_module, private tlm::tlm_bw_transport_if<> {
  tlm::tlm_initiator_socket<32> socket{"socket"};
  NbTransport on_nb;
  std::function<void()> on_invalidate;

  explicit TestInitiator(const sc_core::sc_module_name& name);
  void b_transport(Payload& payload) {
    sc_core::sc_time delay;
    socket->b_transport(payload, delay);
  }
  Sync nb_transport(Payload& payload, tlm::tlm_phase phase,
                    sc_core::sc_time delay = sc_core::SC_ZERO_TIME) {
    return socket->nb_transport_fw(payload, phase, delay);
  }

 private:
  Sync nb_transport_bw(Payload& payload, tlm::tlm_phase& phase, sc_core::sc_time& delay) override;
  void invalidate_direct_mem_ptr(sc_dt::uint64 first, sc_dt::uint64 last) override;
};

/// Takes the base from the address and passes everything on.
struct TestInterconnect : sc_core::sc_module,
                          private tlm::tlm_fw_transport_if<>,
                          private tlm::tlm_bw_transport_if<> {
  tlm::tlm_target_socket<32> target{"target"};
  tlm::tlm_initiator_socket<32> initiator{"initiator"};
  std::function<void(Payload&)> before, after;  // of a forward call

  explicit TestInterconnect(const sc_core::sc_module_name& name);

 private:
  void enter(Payload& payload) const;
  void leave(Payload& payload) const;
  void b_transport(Payload& payload, sc_core::sc_time& delay) override;
  Sync nb_transport_fw(Payload& payload, tlm::tlm_phase& phase, sc_core::sc_time& delay) override;
  Sync nb_transport_bw(Payload& payload, tlm::tlm_phase& phase, sc_core::sc_time& delay) override;
  bool get_direct_mem_ptr(Payload& payload, tlm::tlm_dmi& dmi) override;
  void invalidate_direct_mem_ptr(sc_dt::uint64 first, sc_dt::uint64 last) override;
  unsigned transport_dbg(Payload& payload) override;
};

/// Answers everything well, then does what a test wants in addition.
struct TestTarget : sc_core::sc_module, private tlm::tlm_fw_transport_if<> {
  tlm::tlm_target_socket<32> socket{"socket"};
  std::function<void(Payload&, sc_core::sc_time&)> on_b;
  NbTransport on_nb;
  std::function<void(Payload&, tlm::tlm_dmi&)> on_dmi;
  std::function<unsigned(Payload&)> on_debug;

  explicit TestTarget(const sc_core::sc_module_name& name);
  /// Carries a read, write or ignored command out.
  static void execute(Payload& payload);
  Sync nb_transport(Payload& payload, tlm::tlm_phase phase,
                    sc_core::sc_time delay = sc_core::SC_ZERO_TIME) {
    return socket->nb_transport_bw(payload, phase, delay);
  }

 private:
  void b_transport(Payload& payload, sc_core::sc_time& delay) override;
  Sync nb_transport_fw(Payload& payload, tlm::tlm_phase& phase, sc_core::sc_time& delay) override;
  bool get_direct_mem_ptr(Payload& payload, tlm::tlm_dmi& dmi) override;
  unsigned transport_dbg(Payload& payload) override;

  unsigned char memory_[target_size] = {};
};

struct ProtocolBench {
  ProtocolBench();
  /// As just made.
  void renew();
  /// Runs something in a thread process.
  static void in_thread(const std::function<void()>& work);

  kit::ProtocolWatch watch;
  TestInitiator initiator{"initiator"};
  kit::ProtocolMonitor<> near{"near", watch};
  TestInterconnect interconnect{"interconnect"};
  kit::ProtocolMonitor<> far{"far", watch, kit::Downstream::target};
  TestTarget target{"target"};
  std::set<kit::ProtocolRule> broken;
  std::string said;

 private:
  kit::Listening listening_;
};

/// The one of this program.
ProtocolBench& protocol_bench();

}  // namespace capsoc::test
