// The checks of one ProtocolMonitor.
#pragma once

#include <cstdint>
#include <string>
#include <systemc>
#include <tlm>

#include "kit/protocol_rules.h"
#include "kit/protocol_watch.h"

namespace capsoc::kit {

/// Kind of the component downstream of a monitor.
enum class Downstream {
  unknown,  ///< an interconnect or a target
  target,   ///< a target: it forwards nothing and does not change the address
};

/// Checks the base protocol on one hop: forwards each call unchanged and compares the request with
/// the response. Owned by a ProtocolMonitor; it has no sockets.
class ProtocolChecker {
 public:
  using Payload = tlm::tlm_generic_payload;
  using Forward = tlm::tlm_fw_transport_if<>;
  using Backward = tlm::tlm_bw_transport_if<>;

  /// `watch` must outlive the checker.
  ProtocolChecker(ProtocolWatch& watch, std::string name, Downstream downstream);

  void b_transport(Forward& target, Payload& payload, sc_core::sc_time& delay);
  tlm::tlm_sync_enum nb_transport_fw(Forward& target, Payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);
  tlm::tlm_sync_enum nb_transport_bw(Backward& initiator, Payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);
  bool get_direct_mem_ptr(Forward& target, Payload& payload, tlm::tlm_dmi& dmi);
  void invalidate_direct_mem_ptr(Backward& initiator, sc_dt::uint64 first, sc_dt::uint64 last);
  unsigned transport_dbg(Forward& target, Payload& payload);

 private:
  using Attributes = ProtocolWatch::Attributes;
  using Kind = ProtocolWatch::Kind;
  using Passage = ProtocolWatch::Passage;

  /// The instant at which a call began, to detect a callee that waits.
  class Instant {
   public:
    bool is_now() const {
      return time_ == sc_core::sc_time_stamp() && delta_ == sc_core::sc_delta_count();
    }

   private:
    sc_core::sc_time time_ = sc_core::sc_time_stamp();
    sc_dt::uint64 delta_ = sc_core::sc_delta_count();
  };
  /// Ends a passage with its call, also when the process is killed, which throws an exception.
  struct Ending {
    ProtocolWatch& watch;
    const Payload& payload;
    const Passage& passage;
    ~Ending() { watch.end(payload, &passage); }
  };

  void require(bool holds, ProtocolRule rule, const Payload& payload);
  void require(bool holds, ProtocolRule rule, const std::string& subject);

  Passage& begin(const Payload& payload, Kind kind, const sc_core::sc_time& delay);
  void check_request(const Payload& payload);
  void check_request_is_new(const Passage& passage, const Payload& payload);
  void check_unchanged(const Attributes& given, const Payload& payload, Kind kind);
  void check_arrays(const Attributes& given, const Payload& payload);
  void check_cleared(const Attributes& given, const Payload& payload);
  void check_response(Passage& passage, const Payload& payload);
  void check_address(Passage& passage, const Payload& payload);
  void check_answer(const Passage& passage, const Payload& payload);
  void answer(const Passage& passage, const Payload& payload);
  void check_time(Passage& passage, const Payload& payload, const sc_core::sc_time& delay);
  void check_references(const Payload& payload);
  void check_grant(const Payload& payload, const tlm::tlm_dmi& dmi, uint64_t address, bool granted);

  void check_forward_phase(const Payload& payload, const tlm::tlm_phase& phase,
                           const sc_core::sc_time& delay);
  void begin_request(const Payload& payload, const sc_core::sc_time& delay);
  void check_backward_phase(const Payload& payload, const tlm::tlm_phase& phase);
  void begin_response(Passage& passage, const Payload& payload);
  void check_updated_forward(const Payload& payload, const tlm::tlm_phase& phase, bool ended);
  void check_updated_backward(Passage& passage, const Payload& payload,
                              const tlm::tlm_phase& phase);
  void check_completed(Passage& passage, const Payload& payload, const tlm::tlm_phase& called);
  bool another_is_in(tlm::tlm_phase_enum phase, const Payload& payload) const;

  ProtocolWatch& watch_;
  std::string name_;
  Downstream downstream_;
  unsigned invalidating_ = 0;  // calls under way
};

}  // namespace capsoc::kit
