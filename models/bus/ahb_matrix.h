// The AHB bus matrix: I-code, D-code and system bus of the processor onto memories and the bridge.
#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <functional>
#include <memory>
#include <string>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

#include "bus/address_decoder.h"
#include "kit/clock_domain.h"
#include "kit/direct_route.h"
#include "kit/probe.h"

namespace capsoc::bus {

/// Decodes the address by the map, translates it into an address within the target, and forwards
/// the payload. The payload keeps that address (IEEE 1666-2011, 14.7: an interconnect must not
/// restore it). After the target has answered, the map's wait states are added to the delay. All
/// three target sockets see the whole map: the processor decides which bus carries which address
/// (Cortex-M3 manual, bus interfaces). Arbitration is not modelled: masters that access at the same
/// time cost each other no cycles.
///
/// Further masters (a DMA controller) get their own sockets by add_master(). They get no direct
/// memory, so the matrix sees all their writes and stale code never runs. Listeners of `replaced`
/// are notified. Without listeners, direct memory of the written range is invalidated at the other
/// sockets, which is always correct, but slow.
///
/// An address without a target, or a transfer that leaves its window, gets
/// TLM_ADDRESS_ERROR_RESPONSE. With an invalid map (see error()) no address has a target.
class AhbMatrix : public sc_core::sc_module {
 public:
  using TargetSocket = tlm_utils::simple_target_socket_tagged<AhbMatrix>;
  using InitiatorSocket = tlm_utils::simple_initiator_socket_tagged<AhbMatrix>;

  TargetSocket i_code;
  TargetSocket d_code;
  TargetSocket system;

  AhbMatrix(const sc_core::sc_module_name& name, AddressMap map, const kit::ClockDomain& clock);

  /// The socket to bind to a target: a target name of the map's AHB entries, or apb_bridge_target.
  /// Accesses to all APB entries go through the latter, with the bus address unchanged. nullptr if
  /// the map has no such target. Every existing port must be bound.
  InitiatorSocket* port(const std::string& target);

  /// Notifies of each transfer that was answered, except debug access and direct memory. Arguments:
  /// the payload as it goes back, with the address on the bus and no extensions; begin and end of
  /// the transfer, relative to now.
  kit::TransferProbe transfers;

  /// Adds a target socket for a further master, to be bound like the three of the processor. It is
  /// in a module of that name, a child of the module under construction. Call before the
  /// elaboration ends. Owned by the matrix.
  TargetSocket& add_master(const std::string& name);

  /// Notifies of memory written by a further master: first and last bus address, for each alias.
  kit::Probe<uint64_t, uint64_t> replaced;

  /// The names that port() knows, in the order of the map.
  std::vector<std::string> targets() const;

  const AddressMap& map() const { return decoder_.map(); }
  /// Why the map was refused (one sentence a line), or empty.
  const std::string& error() const { return decoder_.error(); }

 private:
  struct Port {
    std::string target;
    std::unique_ptr<InitiatorSocket> socket;
  };

  /// A socket cannot be added to a module that is complete, so each has one around it.
  struct Master : sc_core::sc_module {
    TargetSocket socket{"socket"};
    explicit Master(const sc_core::sc_module_name& name) : sc_module(name) {}
  };

  void make_ports();
  void serve(TargetSocket& socket, int id);
  Decoded decode(uint64_t address) const;
  void transfer_of_master(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);
  void tell_of_write(uint64_t address, uint64_t length);
  template <typename Call>
  void each_alias(std::size_t port, uint64_t start, uint64_t end, const Call& call);
  void transfer(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);
  void describe_route(kit::DirectRoute& route, uint64_t address, int id);
  void b_transport(int id, tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);
  void show(const tlm::tlm_generic_payload& payload, uint64_t address,
            const sc_core::sc_time& begin, const sc_core::sc_time& end) const;
  unsigned transport_dbg(int id, tlm::tlm_generic_payload& payload);
  unsigned debug_windows(const tlm::tlm_generic_payload& payload);
  bool get_direct_mem_ptr(int id, tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi);
  void invalidate_direct_mem_ptr(int port, sc_dt::uint64 start, sc_dt::uint64 end);
  void invalidate(uint64_t first, uint64_t last);

  AddressDecoder decoder_;
  const kit::ClockDomain& clock_;
  std::vector<Port> ports_;
  std::vector<std::size_t> port_of_entry_;
  std::vector<std::unique_ptr<Master>> masters_;
};

}  // namespace capsoc::bus
