#include "bus/ahb_matrix.h"

#include <algorithm>
#include <utility>

#include "bus/payload.h"
#include "bus/wait_states.h"
#include "kit/early_write.h"
#include "kit/steady_read.h"

namespace capsoc::bus {

namespace {

/// Numbers of the processor's sockets, which begin at 0; those of further masters follow.
constexpr int first_master = 3;

}  // namespace

AhbMatrix::AhbMatrix(const sc_core::sc_module_name& name, AddressMap map,
                     const kit::ClockDomain& clock)
    : sc_module(name),
      i_code("i_code"),
      d_code("d_code"),
      system("system"),
      decoder_(std::move(map)),
      clock_(clock) {
  serve(i_code, 0);
  serve(d_code, 1);
  serve(system, 2);
  make_ports();
}

AhbMatrix::TargetSocket& AhbMatrix::add_master(const std::string& name) {
  masters_.push_back(std::make_unique<Master>(name.c_str()));
  TargetSocket& socket = masters_.back()->socket;
  serve(socket, first_master + static_cast<int>(masters_.size()) - 1);
  return socket;
}

void AhbMatrix::serve(TargetSocket& socket, int id) {
  socket.register_b_transport(this, &AhbMatrix::b_transport, id);
  socket.register_transport_dbg(this, &AhbMatrix::transport_dbg, id);
  socket.register_get_direct_mem_ptr(this, &AhbMatrix::get_direct_mem_ptr, id);
}

void AhbMatrix::make_ports() {
  if (!error().empty()) return;
  for (const MapEntry& entry : map()) {
    const std::string target = entry.bus == BusKind::apb ? apb_bridge_target : entry.target;
    const auto known = std::find_if(ports_.begin(), ports_.end(),
                                    [&](const Port& p) { return p.target == target; });
    port_of_entry_.push_back(static_cast<std::size_t>(known - ports_.begin()));
    if (known != ports_.end()) continue;
    auto socket = std::make_unique<InitiatorSocket>(("to_" + target).c_str());
    socket->register_invalidate_direct_mem_ptr(this, &AhbMatrix::invalidate_direct_mem_ptr,
                                               static_cast<int>(ports_.size()));
    ports_.push_back({target, std::move(socket)});
  }
}

AhbMatrix::InitiatorSocket* AhbMatrix::port(const std::string& target) {
  for (Port& port : ports_)
    if (port.target == target) return port.socket.get();
  return nullptr;
}

std::vector<std::string> AhbMatrix::targets() const {
  std::vector<std::string> names;
  for (const Port& port : ports_) names.push_back(port.target);
  return names;
}

Decoded AhbMatrix::decode(uint64_t address) const {
  Decoded at = decoder_.decode(address);
  if (at.entry != nullptr && at.entry->bus == BusKind::apb) at.local = address;
  return at;
}

void AhbMatrix::b_transport(int id, tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  if (id >= first_master) return transfer_of_master(payload, delay);
  if (!transfers.watched()) {
    const uint64_t on_bus = payload.get_address();
    transfer(payload, delay);
    auto* const route = payload.get_extension<kit::DirectRoute>();
    if (route != nullptr && route->is_described()) describe_route(*route, on_bus, id);
    return;
  }
  auto* const write = payload.get_extension<kit::EarlyWrite>();
  if (write != nullptr && write->early) {
    write->taken = false;
    return payload.set_response_status(tlm::TLM_OK_RESPONSE);
  }
  const uint64_t address = payload.get_address();
  const sc_core::sc_time begin = delay;
  transfer(payload, delay);
  show(payload, address, begin, delay);
  // Each is to be seen, so none is to be left out.
  if (auto* const told = payload.get_extension<kit::SteadyRead>())
    told->steady = told->ahead = false;
  if (write != nullptr) write->taken = false;
}

/// The processor's way through here, which is no longer than a word (kit::DirectRoute).
void AhbMatrix::describe_route(kit::DirectRoute& route, uint64_t address, int id) {
  const Decoded at = decode(address);
  if (at.entry == nullptr || route.transfers != nullptr) return route.clear();
  TargetSocket& socket = id == 0 ? i_code : id == 1 ? d_code : system;
  const unsigned waits = at.entry->bus == BusKind::ahb ? at.entry->wait_states : 0;
  if (route.zeros != nullptr) route.decode(at.local, address, at.window_base, at.window_last);
  route.extend(ports_[port_of_entry_[at.index]].socket->operator->(),
               socket.get_base_export().operator->(), waits);
  route.transfers = &transfers;
}

void AhbMatrix::transfer_of_master(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  const uint64_t address = payload.get_address();
  const sc_core::sc_time begin = delay;
  transfer(payload, delay);
  payload.set_dmi_allowed(false);
  show(payload, address, begin, delay);
  if (payload.is_write() && payload.is_response_ok())
    tell_of_write(address, std::min(payload.get_data_length(), payload.get_streaming_width()));
}

/// Listeners get the address on the bus: the payload has the target's own.
void AhbMatrix::show(const tlm::tlm_generic_payload& payload, uint64_t address,
                     const sc_core::sc_time& begin, const sc_core::sc_time& end) const {
  if (!transfers.watched()) return;
  tlm::tlm_generic_payload seen;
  copy_attributes(payload, seen);
  seen.set_address(address);
  transfers(seen, begin, end);
}

/// All bytes lie in one window, or, of a debugger's write, in several.
void AhbMatrix::tell_of_write(uint64_t address, uint64_t length) {
  const bool told = replaced.watched();
  while (length != 0) {
    const Decoded at = decode(address);
    if (at.entry == nullptr) return;
    const uint64_t part = std::min(length, at.window_last - address + 1);
    each_alias(port_of_entry_[at.index], at.local, at.local + part - 1,
               [&](uint64_t first, uint64_t last) {
                 if (told)
                   replaced(first, last);
                 else
                   invalidate(first, last);
               });
    address += part;
    length -= part;
  }
}

void AhbMatrix::transfer(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  const uint64_t address = payload.get_address();
  const Decoded at = decode(address);
  if (at.entry == nullptr || !fits(payload, address, at.window_last)) {
    payload.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
    add_cycles(clock_, error_response_cycles, delay);
    return;
  }
  payload.set_address(at.local);
  (*ports_[port_of_entry_[at.index]].socket)->b_transport(payload, delay);
  // APB wait states are PREADY's: the bridge adds them.
  if (at.entry->bus == BusKind::ahb)
    add_cycles(clock_, uint64_t{at.entry->wait_states} * word_count(payload), delay);
}

unsigned AhbMatrix::transport_dbg(int id, tlm::tlm_generic_payload& payload) {
  const uint64_t address = payload.get_address();
  const unsigned length = payload.get_data_length();
  const Decoded at = decode(address);
  unsigned done = 0;
  if (at.entry != nullptr && fits(payload, address, at.window_last)) {
    payload.set_address(at.local);
    done = std::min(length, (*ports_[port_of_entry_[at.index]].socket)->transport_dbg(payload));
  } else {
    done = debug_windows(payload);
  }
  if (id >= first_master && payload.is_write()) tell_of_write(address, done);
  return done;
}

/// A debugger may ask for any range: it is served window by window up to the first hole, each part
/// by its own transaction.
unsigned AhbMatrix::debug_windows(const tlm::tlm_generic_payload& payload) {
  const uint64_t address = payload.get_address();
  const unsigned length = payload.get_data_length();
  unsigned done = 0;
  while (done < length) {
    const Decoded at = decode(address + done);
    if (at.entry == nullptr) break;
    const uint64_t room = at.window_last - (address + done) + 1;
    const auto part = static_cast<unsigned>(std::min<uint64_t>(room, length - done));
    tlm::tlm_generic_payload own;
    own.set_command(payload.get_command());
    own.set_address(at.local);
    own.set_data_ptr(payload.get_data_ptr() + done);
    own.set_data_length(part);
    own.set_streaming_width(part);
    const unsigned served = (*ports_[port_of_entry_[at.index]].socket)->transport_dbg(own);
    done += std::min(served, part);
    if (served < part) break;
  }
  return done;
}

bool AhbMatrix::get_direct_mem_ptr(int id, tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi) {
  const uint64_t address = payload.get_address();
  const Decoded at = decode(address);
  dmi.init();
  bool granted = false;
  if (at.entry != nullptr && id < first_master) {
    payload.set_address(at.local);
    granted = (*ports_[port_of_entry_[at.index]].socket)->get_direct_mem_ptr(payload, dmi);
  }
  if (!granted) {
    dmi.allow_none();
    dmi.set_start_address(at.window_base);
    dmi.set_end_address(at.window_last);
    return false;
  }
  // The target's range clipped to the window, then moved to bus addresses.
  const uint64_t local_base = at.local - (address - at.window_base);
  const uint64_t local_last = local_base + (at.window_last - at.window_base);
  const uint64_t first = std::max<uint64_t>(dmi.get_start_address(), local_base);
  const uint64_t last = std::min<uint64_t>(dmi.get_end_address(), local_last);
  dmi.set_dmi_ptr(dmi.get_dmi_ptr() + (first - dmi.get_start_address()));
  dmi.set_start_address(at.window_base + (first - local_base));
  dmi.set_end_address(at.window_base + (last - local_base));
  sc_core::sc_time wait = sc_core::SC_ZERO_TIME;
  add_cycles(clock_, at.entry->wait_states, wait);
  dmi.set_read_latency(dmi.get_read_latency() + wait);
  dmi.set_write_latency(dmi.get_write_latency() + wait);
  return true;
}

void AhbMatrix::invalidate_direct_mem_ptr(int port, sc_dt::uint64 start, sc_dt::uint64 end) {
  each_alias(static_cast<std::size_t>(port), start, end,
             [this](uint64_t first, uint64_t last) { invalidate(first, last); });
}

/// Of the bytes of a port's target from `start` to `end`: call(first, last) with the bus addresses
/// at which each window shows them.
template <typename Call>
void AhbMatrix::each_alias(std::size_t port, uint64_t start, uint64_t end, const Call& call) {
  for (std::size_t i = 0; i < map().size(); ++i) {
    if (port_of_entry_[i] != port) continue;
    const MapEntry& entry = map()[i];
    if (entry.bus == BusKind::apb) continue;  // the bridge grants no direct memory
    const uint64_t first = std::max(start, entry.offset);
    const uint64_t last = std::min(end, entry.offset + entry.window() - 1);
    if (first > last) continue;
    for (uint64_t base = entry.base; base <= entry.last(); base += entry.window())
      call(base + (first - entry.offset), base + (last - entry.offset));
  }
}

/// Further masters have no direct memory.
void AhbMatrix::invalidate(uint64_t first, uint64_t last) {
  for (TargetSocket* socket : {&i_code, &d_code, &system})
    (*socket)->invalidate_direct_mem_ptr(first, last);
}

}  // namespace capsoc::bus
