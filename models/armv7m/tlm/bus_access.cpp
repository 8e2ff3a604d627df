#include "armv7m/tlm/bus_access.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace capsoc::armv7m {
namespace {

constexpr uint32_t code_region_end =
    0x20000000;  // ARMv7-M B3.1: the Code region is served by I-code and D-code

/// The range around an address in which direct memory may lie. Its borders are those of the ports,
/// the bit-band aliases and the private peripheral bus (ARMv7-M B3.1), which the core decodes
/// itself. A port may grant more, up to the whole address space.
struct Range {
  uint64_t first, last;
};
Range part_around(uint32_t address) {
  constexpr std::array<uint64_t, 9> borders{0,          code_region_end, 0x22000000,
                                            0x24000000, 0x42000000,      0x44000000,
                                            0xE0000000, 0xE0100000,      0x100000000};
  const auto* const next = std::upper_bound(borders.begin(), borders.end(), uint64_t{address});
  return {*(next - 1), *next - 1};
}

/// Refusals are remembered by pages of 4 KiB, however far a port says they reach.
uint32_t refusal(uint32_t address, bool store) {
  return (address >> 12) << 1 | (store ? 1 : 0);
}

}  // namespace

BusAccess::BusAccess(const Ports& ports, kit::ClockDomain& clock, Core& core, TimeHorizon& horizon)
    : ports_(ports), clock_(clock), core_(core), horizon_(horizon) {
  // Putting them on and off costs as much as a hop of the bus.
  payload_.set_extension(&steady_);
  payload_.set_extension(&early_);
  payload_.set_extension(&route_);
}

BusAccess::~BusAccess() {
  payload_.clear_extension<kit::SteadyRead>();
  payload_.clear_extension<kit::EarlyWrite>();
  payload_.clear_extension<kit::DirectRoute>();
}

BusAccess::Port& BusAccess::port(uint32_t address, AccessKind kind) {
  if (address >= code_region_end) return ports_.system;
  return kind == AccessKind::fetch ? ports_.icode : ports_.dcode;
}

bool BusAccess::map_if_memory(uint32_t address, AccessKind kind) {
  const bool store = kind == AccessKind::store;
  if (refused_.count(refusal(address, store)) != 0) return false;
  if (map_granted(address, kind, tlm::TLM_WRITE_COMMAND)) return true;
  // A flash grants reads only.
  if (!store && map_granted(address, kind, tlm::TLM_READ_COMMAND)) return true;
  refused_.insert(refusal(address, store));
  return false;
}

/// Maps the memory at an address if its port grants it for this command, and for reads in any case.
bool BusAccess::map_granted(uint32_t address, AccessKind kind, tlm::tlm_command command) {
  tlm::tlm_generic_payload request;
  tlm::tlm_dmi memory;
  request.set_address(address);
  request.set_command(command);
  if (!port(address, kind)->get_direct_mem_ptr(request, memory)) return false;
  if (!memory.is_read_allowed() || memory.get_dmi_ptr() == nullptr) return false;
  if (command == tlm::TLM_WRITE_COMMAND && !memory.is_write_allowed()) return false;
  if (address < memory.get_start_address() || address > memory.get_end_address()) return false;
  map(address, memory);
  return true;
}

void BusAccess::map(uint32_t address, const tlm::tlm_dmi& memory) {
  const Range part = part_around(address);
  const uint64_t first = std::max<uint64_t>(part.first, memory.get_start_address());
  const uint64_t last = std::min<uint64_t>(part.last, memory.get_end_address());
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  const auto wait_states = static_cast<unsigned>(clock_.cycles_at(now + memory.get_read_latency()) -
                                                 clock_.cycles_at(now));
  core_.map_memory(static_cast<uint32_t>(first), static_cast<uint32_t>(last - first + 1),
                   memory.get_dmi_ptr() + (first - memory.get_start_address()),
                   memory.is_write_allowed(), wait_states);
}

void BusAccess::forget_refusals(uint64_t first, uint64_t last) {
  for (auto refused = refused_.begin(); refused != refused_.end();) {
    const uint64_t page = uint64_t{*refused >> 1} << 12;
    refused = page <= last && page + 0xFFF >= first ? refused_.erase(refused) : std::next(refused);
  }
}

void BusAccess::invalidate(uint64_t first, uint64_t last) {
  constexpr uint64_t half = 0x80000000;
  forget_refusals(first, last);
  routes_.forget(first, last);
  if (first <= zeros_.last && last >= zeros_.first) zeros_ = {};
  last = std::min<uint64_t>(last, 2 * half - 1);
  if (first > last) return;
  // All of the address space has no size of 32 bits.
  if (first < half)
    core_.unmap_memory(static_cast<uint32_t>(first),
                       static_cast<uint32_t>(std::min(last, half - 1) - first + 1));
  if (last >= half) {
    const uint64_t from = std::max(first, half);
    core_.unmap_memory(static_cast<uint32_t>(from), static_cast<uint32_t>(last - from + 1));
  }
  granted_.erase(std::remove_if(granted_.begin(), granted_.end(),
                                [&](const Granted& granted) {
                                  return granted.address >= first && granted.address <= last;
                                }),
                 granted_.end());
}

void BusAccess::remap() {
  for (const Granted& granted : granted_) map_if_memory(granted.address, granted.kind);
}

bool BusAccess::may_be_ahead(uint32_t address, AccessKind kind, bool may_write_early) const {
  if (gate_ != nullptr || horizon_.is_late()) return false;
  const unsigned size = payload_.get_data_length();
  if (kind == AccessKind::load) return reads_ahead_.has(address, size);
  return kind == AccessKind::store && may_write_early && early_writes_.has(address, size);
}

/// Makes the transaction that payload_ describes; returns the cycles it took.
unsigned BusAccess::transport(uint32_t address, AccessKind kind, bool may_write_early) {
  const bool ahead = may_be_ahead(address, kind, may_write_early);
  if (!ahead) horizon_.synchronise();
  const unsigned cycles = send(address, kind, ahead);
  if (kind != AccessKind::store || !early_.refused()) return cycles;
  horizon_.synchronise();
  return send(address, kind, false);
}

unsigned BusAccess::send(uint32_t address, AccessKind kind, bool ahead) {
  steady_.steady = steady_.ahead = false;
  // An interconnect leaves its target's address there, and a hint may be left from a refused write.
  payload_.set_address(address);
  payload_.set_dmi_allowed(false);
  payload_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  early_.early = ahead && kind == AccessKind::store;
  early_.taken = false;
  route_.clear();
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  const sc_core::sc_time begin =
      ahead ? clock_.time_of(core_.cycles()) - now : sc_core::SC_ZERO_TIME;
  sc_core::sc_time delay = begin;
  accessing_ = kind;
  horizon_.give_way();  // a target may wait
  port(address, kind)->b_transport(payload_, delay);
  accessing_.reset();
  // A steady read that was made ahead has done nothing.
  if (!ahead || !steady_.steady) horizon_.look_ahead();
  return static_cast<unsigned>(clock_.cycles_at(sc_core::sc_time_stamp() + delay) -
                               clock_.cycles_at(now + begin));
}

/// What the gate makes of an access that it keeps from its target.
std::optional<BusAccess::Result> BusAccess::stopped(tlm::tlm_command command, uint32_t address,
                                                    unsigned size, uint32_t& value) {
  horizon_.synchronise();
  const AccessGate::Fate fate =
      gate_->sent({address, size, command == tlm::TLM_WRITE_COMMAND}, value);
  if (fate == AccessGate::Fate::arrives) return std::nullopt;
  horizon_.look_ahead();
  Result result;
  result.ok = fate == AccessGate::Fate::lost;
  return result;
}

inline BusAccess::Result BusAccess::pass(tlm::tlm_command command, uint32_t address, unsigned size,
                                         uint32_t& value, AccessKind kind, bool may_write_early) {
  uint8_t bytes[4] = {};
  if (command == tlm::TLM_WRITE_COMMAND)
    for (unsigned i = 0; i < size; ++i) bytes[i] = static_cast<uint8_t>(value >> (8 * i));
  payload_.set_command(command);
  payload_.set_data_ptr(bytes);
  payload_.set_data_length(size);
  payload_.set_streaming_width(size);
  Result result;
  result.wait_cycles = transport(address, kind, may_write_early);
  result.steady = steady_.steady;
  result.ok = payload_.is_response_ok();
  result.maps = payload_.is_dmi_allowed() && map_if_memory(address, kind);
  if (result.maps) granted_.push_back({address, kind});

  value = 0;
  for (unsigned i = 0; i < size; ++i) value |= static_cast<uint32_t>(bytes[i]) << (8 * i);
  if (kind == AccessKind::load) reads_ahead_.set(address, size, steady_.ahead);
  if (kind == AccessKind::store) early_writes_.set(address, size, early_.taken);
  note_route(result, address, kind);
  return result;
}

/// Remembers the way of the access that payload_ describes, if another one may do without.
void BusAccess::note_route(const Result& result, uint32_t address, AccessKind kind) {
  const bool described = result.ok && route_.is_whole(port(address, kind).operator->()) &&
                         route_.cycles == result.wait_cycles;
  if (kind == AccessKind::fetch) {
    if (described && route_.zeros != nullptr) note_zeros(address);
    return;
  }
  const bool is_store = kind == AccessKind::store;
  const bool may_be_ahead = route_.target != nullptr && (is_store ? early_.taken : steady_.ahead);
  routes_.note(address, payload_.get_data_length(), is_store,
               described && may_be_ahead ? &route_ : nullptr);
}

void BusAccess::note_zeros(uint32_t address) {
  // A window may reach past the Code region, where another port serves.
  const Range part = part_around(address);
  zeros_ = {route_.zeros, route_.transfers, std::max(route_.first, part.first),
            std::min(route_.last, part.last), route_.cycles};
}

std::optional<BusAccess::Result> BusAccess::fetch_directly(uint32_t address) {
  if (zeros_.target == nullptr || address < zeros_.first || address + uint64_t{1} > zeros_.last)
    return std::nullopt;
  const bool is_open = zeros_.transfers == nullptr || !zeros_.transfers->watched();
  if (!is_open || gate_ != nullptr || horizon_.is_late()) return std::nullopt;
  zeros_.target->read_zero();
  Result result;
  result.ok = result.quiet = true;
  result.wait_cycles = zeros_.cycles;
  return result;
}

/// The way of an access ahead of the kernel that needs no transaction; null: it does.
inline const DirectRoutes::Route* BusAccess::route(uint32_t address, unsigned size,
                                                   bool write) const {
  const DirectRoutes::Route* const known = routes_.find(address, size, write);
  const bool is_open = known != nullptr && gate_ == nullptr && known->is_open();
  return is_open && !horizon_.is_late() ? known : nullptr;
}

std::optional<BusAccess::Result> BusAccess::read_directly(uint32_t address, unsigned size,
                                                          uint32_t& value) {
  const DirectRoutes::Route* const way = route(address, size, false);
  if (way == nullptr) return std::nullopt;
  Result result;
  result.ok = true;
  result.wait_cycles = way->cycles();
  result.quiet = !way->read(value, clock_.time_of(core_.cycles()));
  result.steady = way->is_steady();
  if (!result.quiet) horizon_.look_ahead();
  return result;
}

std::optional<BusAccess::Result> BusAccess::write_directly(uint32_t address, unsigned size,
                                                           uint32_t value) {
  const DirectRoutes::Route* const way = route(address, size, true);
  if (way == nullptr || !way->write(value, clock_.time_of(core_.cycles()))) return std::nullopt;
  horizon_.look_ahead();
  Result result;
  result.ok = true;
  result.wait_cycles = way->cycles();
  return result;
}

BusAccess::Result BusAccess::access(tlm::tlm_command command, uint32_t address, unsigned size,
                                    uint32_t& value, AccessKind kind, bool may_write_early) {
  if (__builtin_expect(gate_ == nullptr, 1))
    return pass(command, address, size, value, kind, may_write_early);
  if (const auto result = stopped(command, address, size, value)) return *result;
  Result result = pass(command, address, size, value, kind, false);
  result.steady = false;
  if (command == tlm::TLM_READ_COMMAND) gate_->returned({address, size, false}, value);
  return result;
}

}  // namespace capsoc::armv7m
