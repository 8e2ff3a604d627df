// A monitor of the TLM-2.0 base protocol.
#pragma once

#include <systemc>
#include <tlm>

#include "kit/protocol_checker.h"
#include "kit/protocol_watch.h"

namespace capsoc::kit {

/// Is bound between an initiator socket and a target socket and reports violations of the base
/// protocol's rules (protocol_rules.def). It is a transparent component (IEEE 1666-2011, 15.2.5):
/// it takes no time, changes nothing and answers no call itself. It checks blocking, non-blocking,
/// direct memory and debug calls.
///
///     kit::ProtocolWatch watch;
///     kit::ProtocolMonitor<> monitor("monitor", watch);
///     initiator.socket.bind(monitor.from_initiator);
///     monitor.to_target.bind(target.socket);
///
/// Monitors of one system share a watch. An interconnect between two monitors is checked as well
/// where it passes a payload on; not where it makes a separate payload.
template <unsigned BUSWIDTH = 32>
class ProtocolMonitor : public sc_core::sc_module,
                        private tlm::tlm_fw_transport_if<>,
                        private tlm::tlm_bw_transport_if<> {
 public:
  tlm::tlm_target_socket<BUSWIDTH> from_initiator{"from_initiator"};
  tlm::tlm_initiator_socket<BUSWIDTH> to_target{"to_target"};

  /// `watch` is not owned.
  ProtocolMonitor(const sc_core::sc_module_name& name, ProtocolWatch& watch,
                  Downstream downstream = Downstream::unknown)
      : sc_module(name), checker_(watch, this->name(), downstream) {
    from_initiator.bind(*this);
    to_target.bind(*this);
  }

 private:
  using Payload = tlm::tlm_generic_payload;

  tlm::tlm_fw_transport_if<>& target() { return *to_target[0]; }
  tlm::tlm_bw_transport_if<>& initiator() { return *from_initiator.get_base_port()[0]; }

  void b_transport(Payload& payload, sc_core::sc_time& delay) override {
    checker_.b_transport(target(), payload, delay);
  }
  tlm::tlm_sync_enum nb_transport_fw(Payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    return checker_.nb_transport_fw(target(), payload, phase, delay);
  }
  tlm::tlm_sync_enum nb_transport_bw(Payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    return checker_.nb_transport_bw(initiator(), payload, phase, delay);
  }
  bool get_direct_mem_ptr(Payload& payload, tlm::tlm_dmi& dmi) override {
    return checker_.get_direct_mem_ptr(target(), payload, dmi);
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64 first, sc_dt::uint64 last) override {
    checker_.invalidate_direct_mem_ptr(initiator(), first, last);
  }
  unsigned transport_dbg(Payload& payload) override {
    return checker_.transport_dbg(target(), payload);
  }

  ProtocolChecker checker_;
};

}  // namespace capsoc::kit
