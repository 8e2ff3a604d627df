// The AHB-to-APB bridge with the APB's address decoding.
#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <memory>
#include <string>
#include <systemc>
#include <tlm>
#include <vector>

#include "bus/address_decoder.h"
#include "kit/clock_domain.h"

namespace capsoc::bus {

/// Cycles of one APB transfer whose device is ready at once: SETUP and ACCESS (AMBA APB,
/// transfers).
constexpr unsigned apb_transfer_cycles = 2;

/// Serves the APB entries of a map, addressed by bus address.
///
/// The APB has only aligned 32-bit transfers. A read of a byte or half-word becomes a read of the
/// whole word; without read strobes, it has the side effects of the whole word. A partial write
/// becomes one word with byte enables (PSTRB). A longer burst becomes a sequence of words. Each
/// transfer costs apb_transfer_cycles, plus the map's wait states, plus what the device adds to the
/// delay (PREADY).
///
/// Each transfer is a separate transaction of the bridge, with capsoc's extensions copied from the
/// initiator's payload. A payload that was only passed on could not report PSLVERR: an interconnect
/// must not change the device's response status (IEEE 1666-2011, 14.7).
///
/// Answers:
/// - TLM_BURST_ERROR_RESPONSE: a length that no AHB transfer has, or streaming
/// - TLM_ADDRESS_ERROR_RESPONSE: misaligned, or no device is selected, or the device's own answer
/// - TLM_GENERIC_ERROR_RESPONSE: any other error of the device (PSLVERR)
/// TLM_IGNORE_COMMAND makes no transfer. There is no direct memory.
class ApbBridge : public sc_core::sc_module {
 public:
  using InitiatorSocket = tlm_utils::simple_initiator_socket<ApbBridge>;

  tlm_utils::simple_target_socket<ApbBridge> socket;

  /// Takes the APB entries of the map, leaves the others.
  ApbBridge(const sc_core::sc_module_name& name, const AddressMap& map,
            const kit::ClockDomain& clock);

  /// The socket to bind to a target of the map's APB entries; nullptr if there is none of that
  /// name. Every existing port must be bound.
  InitiatorSocket* port(const std::string& target);
  std::vector<std::string> targets() const;

  const AddressMap& map() const { return decoder_.map(); }
  const std::string& error() const { return decoder_.error(); }

 private:
  struct Port {
    std::string target;
    std::unique_ptr<InitiatorSocket> socket;
  };

  class Transfer;
  void describe_route(tlm::tlm_generic_payload& transfer, const Decoded& at);

  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);
  tlm::tlm_response_status transfer(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);
  tlm::tlm_response_status transfer_plain(tlm::tlm_generic_payload& payload, const Decoded& at,
                                          sc_core::sc_time& delay);
  tlm::tlm_response_status transfer_word(tlm::tlm_generic_payload& payload, const Decoded& at,
                                         uint64_t bus_word, sc_core::sc_time& delay);
  unsigned transport_dbg(tlm::tlm_generic_payload& payload);
  bool debug_word(uint64_t address, unsigned lane, unsigned count, bool write,
                  unsigned char* bytes);

  AddressDecoder decoder_;
  const kit::ClockDomain& clock_;
  std::vector<Port> ports_;
  std::vector<std::size_t> port_of_entry_;
  /// Reused payloads: constructing one takes as long as a transfer.
  std::vector<std::unique_ptr<tlm::tlm_generic_payload>> spare_;
};

}  // namespace capsoc::bus
