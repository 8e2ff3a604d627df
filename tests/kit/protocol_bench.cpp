#include "protocol_bench.h"

#include <algorithm>
#include <memory>

#include "bench_main.h"

namespace capsoc::test {
namespace {

std::unique_ptr<ProtocolBench> the_bench;

}  // namespace

TestInitiator::TestInitiator(const sc_core::sc_module_name& name) : sc_module(name) {
  socket.bind(*this);
}

Sync TestInitiator::nb_transport_bw(Payload& payload, tlm::tlm_phase& phase,
                                    sc_core::sc_time& delay) {
  return on_nb ? on_nb(payload, phase, delay) : tlm::TLM_ACCEPTED;
}

void TestInitiator::invalidate_direct_mem_ptr(sc_dt::uint64, sc_dt::uint64) {
  if (on_invalidate) on_invalidate();
}

TestInterconnect::TestInterconnect(const sc_core::sc_module_name& name) : sc_module(name) {
  target.bind(*this);
  initiator.bind(*this);
}

void TestInterconnect::enter(Payload& payload) const {
  payload.set_address(payload.get_address() - target_base);
  if (before) before(payload);
}

void TestInterconnect::leave(Payload& payload) const {
  if (after) after(payload);
}

void TestInterconnect::b_transport(Payload& payload, sc_core::sc_time& delay) {
  enter(payload);
  initiator->b_transport(payload, delay);
  leave(payload);
}

Sync TestInterconnect::nb_transport_fw(Payload& payload, tlm::tlm_phase& phase,
                                       sc_core::sc_time& delay) {
  if (phase == tlm::BEGIN_REQ) enter(payload);
  const Sync status = initiator->nb_transport_fw(payload, phase, delay);
  leave(payload);
  return status;
}

Sync TestInterconnect::nb_transport_bw(Payload& payload, tlm::tlm_phase& phase,
                                       sc_core::sc_time& delay) {
  return target->nb_transport_bw(payload, phase, delay);
}

bool TestInterconnect::get_direct_mem_ptr(Payload& payload, tlm::tlm_dmi& dmi) {
  enter(payload);
  const bool granted = initiator->get_direct_mem_ptr(payload, dmi);
  dmi.set_start_address(dmi.get_start_address() + target_base);
  dmi.set_end_address(dmi.get_end_address() + target_base);
  leave(payload);
  return granted;
}

void TestInterconnect::invalidate_direct_mem_ptr(sc_dt::uint64 first, sc_dt::uint64 last) {
  target->invalidate_direct_mem_ptr(first + target_base, last + target_base);
}

unsigned TestInterconnect::transport_dbg(Payload& payload) {
  enter(payload);
  const unsigned done = initiator->transport_dbg(payload);
  leave(payload);
  return done;
}

TestTarget::TestTarget(const sc_core::sc_module_name& name) : sc_module(name) {
  socket.bind(*this);
}

void TestTarget::execute(Payload& payload) {
  const unsigned char* const enables = payload.get_byte_enable_ptr();
  if (payload.is_read() && payload.get_data_ptr() != nullptr)
    for (unsigned i = 0; i < payload.get_data_length(); ++i)
      if (enables == nullptr || payload.get_byte_enable_length() == 0 ||
          enables[i % payload.get_byte_enable_length()] == TLM_BYTE_ENABLED)
        ++payload.get_data_ptr()[i];
  payload.set_response_status(tlm::TLM_OK_RESPONSE);
}

void TestTarget::b_transport(Payload& payload, sc_core::sc_time& delay) {
  execute(payload);
  if (on_b) on_b(payload, delay);
}

Sync TestTarget::nb_transport_fw(Payload& payload, tlm::tlm_phase& phase, sc_core::sc_time& delay) {
  if (on_nb) return on_nb(payload, phase, delay);
  if (phase == tlm::BEGIN_REQ) execute(payload);
  return phase == tlm::BEGIN_REQ || phase == tlm::END_RESP ? tlm::TLM_COMPLETED : tlm::TLM_ACCEPTED;
}

bool TestTarget::get_direct_mem_ptr(Payload& payload, tlm::tlm_dmi& dmi) {
  dmi.set_dmi_ptr(memory_);
  dmi.set_start_address(0);
  dmi.set_end_address(target_size - 1);
  dmi.allow_read_write();
  if (on_dmi) on_dmi(payload, dmi);
  return true;
}

unsigned TestTarget::transport_dbg(Payload& payload) {
  return on_debug ? on_debug(payload) : payload.get_data_length();
}

ProtocolBench::ProtocolBench() {
  initiator.socket.bind(near.from_initiator);
  near.to_target.bind(interconnect.target);
  interconnect.initiator.bind(far.from_initiator);
  far.to_target.bind(target.socket);
  listening_ = watch.violated.listen([this](const kit::ProtocolViolation& violation) {
    broken.insert(violation.rule);
    said += violation.text + "\n";
  });
}

void ProtocolBench::renew() {
  watch.forget_transactions();
  initiator.on_nb = nullptr;
  initiator.on_invalidate = nullptr;
  interconnect.before = interconnect.after = nullptr;
  target.on_b = nullptr;
  target.on_nb = nullptr;
  target.on_dmi = nullptr;
  target.on_debug = nullptr;
  broken.clear();
  said.clear();
}

void ProtocolBench::in_thread(const std::function<void()>& work) {
  sc_core::sc_spawn(work);
  sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_US));
}

ProtocolBench& protocol_bench() {
  return *the_bench;
}

}  // namespace capsoc::test

int sc_main(int argc, char** argv) {
  return capsoc::test::run_on_bench(argc, argv, capsoc::test::the_bench);
}
