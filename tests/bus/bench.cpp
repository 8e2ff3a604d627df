#include "bench.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "../kit/bench_main.h"
#include "kit/early_write.h"

namespace capsoc::test {
namespace {

using bus::AddressMap;
using bus::BusKind;
using bus::MapEntry;
using bus::TargetKind;

MapEntry memory(const char* name, const char* target, uint64_t base, uint64_t size) {
  MapEntry entry;
  entry.name = name;
  entry.target = target;
  entry.base = base;
  entry.size = size;
  entry.kind = TargetKind::memory;
  return entry;
}

MapEntry device(const char* name, uint64_t base, BusKind bus, unsigned wait_states = 0) {
  MapEntry entry = memory(name, name, base, 0x1000);
  entry.kind = TargetKind::device;
  entry.bus = bus;
  entry.wait_states = wait_states;
  return entry;
}

AddressMap bench_map() {
  AddressMap map = {memory("ram", "ram", at::ram, 0x1000),
                    memory("ram_alias", "ram", at::ram_alias, 0x800),
                    memory("slow_ram", "slow_ram", at::slow_ram, 0x1000),
                    memory("small_ram", "small_ram", at::small_ram, 0x1000),
                    device("probe", at::probe, BusKind::apb),
                    device("sluggish", at::sluggish, BusKind::apb, 5),
                    device("absent", at::absent, BusKind::ahb)};
  map[1].offset = 0x800;
  map[2].wait_states = 3;
  map[3].wrap = 0x400;
  return map;
}

/// Rules of what an initiator hands over: the first of the table, of a transport call.
bool is_of_initiator(kit::ProtocolRule rule) {
  return rule <= kit::ProtocolRule::option_set || rule == kit::ProtocolRule::dmi_descriptor_used ||
         rule == kit::ProtocolRule::debug_pointer_null;
}

std::unique_ptr<Bench> the_bench;

}  // namespace

Probe::Probe(sc_core::sc_module_name name) : sc_module(name) {
  socket.register_b_transport(this, &Probe::b_transport);
  socket.register_transport_dbg(this, &Probe::transport_dbg);
}

void Probe::forget() {
  transfers.clear();
  read_value = debug_value = 0;
  response = tlm::TLM_OK_RESPONSE;
  ready_after = sc_core::SC_ZERO_TIME;
  takes_early = false;
}

void Probe::b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  Transfer seen{payload.get_command(), payload.get_address(), payload.get_data_length(), 0, 0xf};
  std::memcpy(&seen.data, payload.get_data_ptr(), 4);
  if (payload.get_byte_enable_ptr() != nullptr) {
    seen.strobes = 0;
    for (unsigned i = 0; i < 4; ++i)
      if (payload.get_byte_enable_ptr()[i] == TLM_BYTE_ENABLED) seen.strobes |= 1u << i;
  }
  transfers.push_back(seen);
  if (payload.is_read()) std::memcpy(payload.get_data_ptr(), &read_value, 4);
  if (auto* const told = payload.get_extension<kit::EarlyWrite>()) told->taken = takes_early;
  delay += ready_after;
  payload.set_response_status(response);
}

unsigned Probe::transport_dbg(tlm::tlm_generic_payload& payload) {
  if (payload.get_data_length() != 4) return 0;
  if (payload.is_read())
    std::memcpy(payload.get_data_ptr(), &debug_value, 4);
  else
    std::memcpy(&debug_value, payload.get_data_ptr(), 4);
  return 4;
}

Bench::Bench()
    : matrix("matrix", bench_map(), clock),
      bridge("bridge", bench_map(), clock),
      ram("ram", 0x1000),
      slow_ram("slow_ram", 0x1000),
      small_ram("small_ram", 0x400),
      probe("probe"),
      sluggish("sluggish"),
      absent("absent", "absent", at::absent, [this] { return pc; }),
      fetch("fetch"),
      load("load"),
      system("system"),
      dma("dma"),
      video("video") {
  const auto unknown = kit::Downstream::unknown, target = kit::Downstream::target;
  connect(fetch.socket, matrix.i_code, unknown);
  connect(load.socket, matrix.d_code, unknown);
  connect(system.socket, matrix.system, unknown);
  connect(dma.socket, matrix.add_master("dma_port"), unknown);
  connect(*matrix.port("ram"), ram.socket, target);
  connect(video.socket, ram.socket, target);  // a second port
  connect(*matrix.port("slow_ram"), slow_ram.socket, target);
  connect(*matrix.port("small_ram"), small_ram.socket, target);
  connect(*matrix.port("absent"), absent.socket, target);
  connect(*matrix.port(bus::apb_bridge_target), bridge.socket, unknown);
  connect(*bridge.port("probe"), probe.socket, target);
  connect(*bridge.port("sluggish"), sluggish.socket, target);
  listening_ = watch.violated.listen([this](const kit::ProtocolViolation& violation) {
    (is_of_initiator(violation.rule) ? initiators_faults : faults) += violation.text + "\n";
  });
}

template <typename From, typename To>
void Bench::connect(From& initiator, To& target, kit::Downstream downstream) {
  kit::ProtocolMonitor<>& monitor =
      monitors_.emplace_back(sc_core::sc_gen_unique_name("monitor"), watch, downstream);
  initiator.bind(monitor.from_initiator);
  monitor.to_target.bind(target);
}

void Bench::forget() {
  EXPECT_EQ(faults, "");
  faults.clear();
  initiators_faults.clear();
  ram.clear();
  slow_ram.clear();
  small_ram.clear();
  probe.forget();
  sluggish.forget();
  for (Initiator* each : {&fetch, &load, &system, &dma, &video}) each->invalidated.clear();
}

Bench& bench() {
  return *the_bench;
}

}  // namespace capsoc::test

int sc_main(int argc, char** argv) {
  return capsoc::test::run_on_bench(argc, argv, capsoc::test::the_bench);
}
