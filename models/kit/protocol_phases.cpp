// ProtocolChecker: nb_transport.
#include "kit/protocol_checker.h"

namespace capsoc::kit {
namespace {

bool is_base_phase(const tlm::tlm_phase& phase) {
  return phase <= tlm::END_RESP;
}

bool is_initiators(const tlm::tlm_phase& phase) {
  return phase == tlm::BEGIN_REQ || phase == tlm::END_RESP;
}

bool is_targets(const tlm::tlm_phase& phase) {
  return phase == tlm::END_REQ || phase == tlm::BEGIN_RESP;
}

}  // namespace

bool ProtocolChecker::another_is_in(tlm::tlm_phase_enum phase, const Payload& payload) const {
  for (const auto& [other, path] : watch_.under_way_)
    for (const Passage& passage : path)
      if (other != &payload && passage.hop == this && passage.phase == phase) return true;
  return false;
}

void ProtocolChecker::begin_request(const Payload& payload, const sc_core::sc_time& delay) {
  check_request(payload);
  if (Passage* const other = watch_.find(payload, this)) {
    require(other->kind != Kind::blocking, ProtocolRule::mixed_transport, payload);
    require(other->kind != Kind::nonblocking, ProtocolRule::phase_order, payload);
    return;
  }
  require(!another_is_in(tlm::BEGIN_REQ, payload), ProtocolRule::request_exclusion, payload);
  Passage& passage = begin(payload, Kind::nonblocking, delay);
  passage.phase = tlm::BEGIN_REQ;
  check_request_is_new(passage, payload);
}

void ProtocolChecker::check_forward_phase(const Payload& payload, const tlm::tlm_phase& phase,
                                          const sc_core::sc_time& delay) {
  if (phase == tlm::BEGIN_REQ) return begin_request(payload, delay);
  Passage* const passage = watch_.find(payload, this);
  const bool begun = passage != nullptr && passage->kind == Kind::nonblocking;
  if (!is_base_phase(phase))
    require(begun, ProtocolRule::phase_outside, payload);
  else if (phase != tlm::END_RESP)
    require(false, ProtocolRule::phase_direction, payload);
  else
    require(begun && passage->phase == tlm::BEGIN_RESP, ProtocolRule::phase_order, payload);
  if (!begun) return;
  check_time(*passage, payload, delay);
  check_unchanged(passage->given, payload, Kind::nonblocking);
}

tlm::tlm_sync_enum ProtocolChecker::nb_transport_fw(Forward& target, Payload& payload,
                                                    tlm::tlm_phase& phase,
                                                    sc_core::sc_time& delay) {
  require(payload.has_mm(), ProtocolRule::memory_manager_missing, payload);
  check_references(payload);
  const tlm::tlm_phase called = phase;
  const sc_core::sc_time called_delay = delay;
  const Instant begun;
  check_forward_phase(payload, phase, delay);
  const tlm::tlm_sync_enum status = target.nb_transport_fw(payload, phase, delay);
  require(begun.is_now(), ProtocolRule::nb_waits, payload);
  Passage* const passage = watch_.find(payload, this);
  if (passage != nullptr && passage->kind == Kind::nonblocking) {
    check_unchanged(passage->given, payload, Kind::nonblocking);
    if (status != tlm::TLM_ACCEPTED) check_time(*passage, payload, delay);
    if (status == tlm::TLM_COMPLETED) check_completed(*passage, payload, called);
  }
  if (status == tlm::TLM_ACCEPTED)
    require(phase == called && delay == called_delay, ProtocolRule::accepted_changed, payload);
  if (status == tlm::TLM_UPDATED) check_updated_forward(payload, phase, called == tlm::END_RESP);
  if (status == tlm::TLM_COMPLETED || called == tlm::END_RESP)
    watch_.end(payload, watch_.find(payload, this));
  return status;
}

/// The target has continued to a phase in its answer to a forward call.
void ProtocolChecker::check_updated_forward(const Payload& payload, const tlm::tlm_phase& phase,
                                            bool ended) {
  if (ended) return require(false, ProtocolRule::phase_order, payload);
  check_backward_phase(payload, phase);
}

/// TLM_COMPLETED to BEGIN_REQ has a response with it.
void ProtocolChecker::check_completed(Passage& passage, const Payload& payload,
                                      const tlm::tlm_phase& called) {
  require(called == tlm::BEGIN_REQ || called == tlm::END_RESP, ProtocolRule::completion, payload);
  if (called != tlm::BEGIN_REQ) return;
  passage.phase = tlm::END_REQ;
  begin_response(passage, payload);
}

void ProtocolChecker::begin_response(Passage& passage, const Payload& payload) {
  require(passage.phase == tlm::BEGIN_REQ || passage.phase == tlm::END_REQ,
          ProtocolRule::phase_order, payload);
  require(!another_is_in(tlm::BEGIN_RESP, payload), ProtocolRule::response_exclusion, payload);
  passage.phase = tlm::BEGIN_RESP;
  bool is_behind = false, all_responded = true;
  for (const Passage& each : watch_.path(payload)) {
    if (is_behind) all_responded = all_responded && each.responded;
    is_behind = is_behind || &each == &passage;
  }
  require(all_responded, ProtocolRule::response_before_target, payload);
  passage.responded = true;
  check_response(passage, payload);
}

/// A phase from the target's side, by a call or in an answer.
void ProtocolChecker::check_backward_phase(const Payload& payload, const tlm::tlm_phase& phase) {
  Passage* const passage = watch_.find(payload, this);
  const bool begun = passage != nullptr && passage->kind == Kind::nonblocking;
  if (!is_base_phase(phase)) return require(begun, ProtocolRule::phase_outside, payload);
  if (!is_targets(phase)) return require(false, ProtocolRule::phase_direction, payload);
  if (!begun) return require(false, ProtocolRule::phase_order, payload);
  if (phase == tlm::BEGIN_RESP) return begin_response(*passage, payload);
  require(passage->phase == tlm::BEGIN_REQ, ProtocolRule::phase_order, payload);
  passage->phase = tlm::END_REQ;
}

tlm::tlm_sync_enum ProtocolChecker::nb_transport_bw(Backward& initiator, Payload& payload,
                                                    tlm::tlm_phase& phase,
                                                    sc_core::sc_time& delay) {
  ++watch_.calls_;
  require(payload.has_mm(), ProtocolRule::memory_manager_missing, payload);
  check_references(payload);
  const tlm::tlm_phase called = phase;
  const sc_core::sc_time called_delay = delay;
  const Instant begun;
  if (Passage* const passage = watch_.find(payload, this)) {
    check_time(*passage, payload, delay);
    check_unchanged(passage->given, payload, Kind::nonblocking);
  }
  check_backward_phase(payload, phase);
  const tlm::tlm_sync_enum status = initiator.nb_transport_bw(payload, phase, delay);
  require(begun.is_now(), ProtocolRule::nb_waits, payload);
  Passage* const passage = watch_.find(payload, this);
  if (status == tlm::TLM_ACCEPTED)
    require(phase == called && delay == called_delay, ProtocolRule::accepted_changed, payload);
  if (passage == nullptr) return status;
  if (status == tlm::TLM_UPDATED) {
    check_time(*passage, payload, delay);
    check_updated_backward(*passage, payload, phase);
  }
  if (status == tlm::TLM_COMPLETED) {
    check_time(*passage, payload, delay);
    require(called == tlm::BEGIN_RESP, ProtocolRule::completion, payload);
    watch_.end(payload, passage);
  }
  return status;
}

/// The initiator has continued to a phase in its answer to a backward call.
void ProtocolChecker::check_updated_backward(Passage& passage, const Payload& payload,
                                             const tlm::tlm_phase& phase) {
  if (!is_base_phase(phase)) return;
  if (!is_initiators(phase)) return require(false, ProtocolRule::phase_direction, payload);
  require(phase == tlm::END_RESP && passage.phase == tlm::BEGIN_RESP, ProtocolRule::phase_order,
          payload);
  if (phase == tlm::END_RESP) watch_.end(payload, &passage);
}

}  // namespace capsoc::kit
