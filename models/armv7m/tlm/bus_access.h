#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <systemc>
#include <tlm>
#include <unordered_set>
#include <vector>

#include "armv7m/core.h"
#include "armv7m/tlm/access_gate.h"
#include "armv7m/tlm/direct_routes.h"
#include "armv7m/tlm/time_horizon.h"
#include "base/archive.h"
#include "kit/clock_domain.h"
#include "kit/early_write.h"
#include "kit/steady_read.h"

namespace capsoc::armv7m {

/// Turns the core's accesses into transactions on the three AHB-Lite ports, each at its exact time.
/// Before an access the kernel catches up with the core. The exception is a device that takes the
/// time of the access as a delay (kit::SteadyRead, kit::EarlyWrite), if the kernel has no activity
/// before that time. If the way to the device is known (kit::DirectRoute), such an access needs no
/// transaction. Maps direct memory that a port grants. Nothing passed in is owned.
class BusAccess {
 public:
  using Port = tlm::tlm_initiator_socket<32>;
  struct Ports {
    Port& icode;   ///< instruction fetches below 0x20000000
    Port& dcode;   ///< data accesses below 0x20000000
    Port& system;  ///< everything else
  };
  struct Result {
    bool ok = false;
    bool steady = false;  ///< side-effect-free and stable, as the device said
    bool maps = false;    ///< the memory was mapped: later accesses do not use the bus
    bool quiet = false;   ///< nothing has changed that the horizon depends on
    unsigned wait_cycles = 0;
  };

  BusAccess(const Ports& ports, kit::ClockDomain& clock, Core& core, TimeHorizon& horizon);
  ~BusAccess();
  BusAccess(const BusAccess&) = delete;
  BusAccess& operator=(const BusAccess&) = delete;

  /// Makes an access of 1, 2 or 4 bytes and looks ahead again. `may_write_early`: a write that the
  /// device takes early need not wait for the kernel.
  Result access(tlm::tlm_command command, uint32_t address, unsigned size, uint32_t& value,
                AccessKind kind, bool may_write_early);
  /// The same of an access ahead of the kernel that needs no transaction. Empty, and nothing is
  /// done: it does, or it has to wait for the kernel.
  std::optional<Result> read_directly(uint32_t address, unsigned size, uint32_t& value);
  std::optional<Result> write_directly(uint32_t address, unsigned size, uint32_t value);
  /// The same of a fetch; it gets 0.
  std::optional<Result> fetch_directly(uint32_t address);
  /// Kind of the access that is on a socket now; empty: there is none.
  std::optional<AccessKind> accessing() const { return accessing_; }

  /// Asked about each access from here on; null: none is. Not owned.
  void set_gate(AccessGate* gate) { gate_ = gate; }

  /// The port revokes direct memory.
  void invalidate(uint64_t first, uint64_t last);
  /// Saves or loads the granted memory; after a restore remap() maps it again.
  void visit(Archive& archive) { archive.sequence("granted", granted_, 4096); }
  void remap();

 private:
  /// Direct memory that was granted: the first access to it went over the bus and took its time.
  struct Granted {
    uint32_t address = 0;
    AccessKind kind = AccessKind::load;
    void visit(Archive& archive) {
      archive("address", address);
      archive.at_most("kind", kind, AccessKind::store);
    }
  };

  /// The last accesses of a kind, each at a place that its address chooses.
  class Places {
   public:
    bool has(uint32_t address, unsigned size) const {
      return accesses_[place_of(address)] == access_of(address, size);
    }
    /// From now on has() says so of this access.
    void set(uint32_t address, unsigned size, bool has_it) {
      if (has_it || has(address, size))
        accesses_[place_of(address)] = has_it ? access_of(address, size) : 0;
    }

   private:
    static constexpr std::size_t count = 16;
    static std::size_t place_of(uint32_t address) { return (address >> 2 ^ address >> 12) % count; }
    /// Never 0.
    static uint64_t access_of(uint32_t address, unsigned size) {
      return uint64_t{address} << 8 | size;
    }
    std::array<uint64_t, count> accesses_{};
  };

  /// Where code is fetched from a target that reads 0 at all addresses (kit::ZeroTarget).
  struct Zeros {
    kit::ZeroTarget* target = nullptr;
    const kit::TransferProbe* transfers = nullptr;
    uint64_t first = 0, last = 0;
    unsigned cycles = 0;
  };

  Port& port(uint32_t address, AccessKind kind);
  bool may_be_ahead(uint32_t address, AccessKind kind, bool may_write_early) const;
  std::optional<Result> stopped(tlm::tlm_command command, uint32_t address, unsigned size,
                                uint32_t& value);
  Result pass(tlm::tlm_command command, uint32_t address, unsigned size, uint32_t& value,
              AccessKind kind, bool may_write_early);
  unsigned transport(uint32_t address, AccessKind kind, bool may_write_early);
  unsigned send(uint32_t address, AccessKind kind, bool ahead);
  const DirectRoutes::Route* route(uint32_t address, unsigned size, bool write) const;
  void note_route(const Result& result, uint32_t address, AccessKind kind);
  void note_zeros(uint32_t address);
  bool map_if_memory(uint32_t address, AccessKind kind);
  bool map_granted(uint32_t address, AccessKind kind, tlm::tlm_command command);
  void map(uint32_t address, const tlm::tlm_dmi& memory);
  void forget_refusals(uint64_t first, uint64_t last);

  Ports ports_;
  kit::ClockDomain& clock_;
  Core& core_;
  TimeHorizon& horizon_;
  tlm::tlm_generic_payload payload_;  // reused: constructing one takes as long as an access
  kit::SteadyRead steady_;            // on the payload: of the last read
  kit::EarlyWrite early_;             // on the payload: of the last write
  Places reads_ahead_;                // that may be made ahead
  Places early_writes_;               // that were taken early, or would be
  kit::DirectRoute route_;            // on the payload: of the last access
  DirectRoutes routes_;               // of those that may be made ahead
  Zeros zeros_;                       // around the last fetch that met such
  std::optional<AccessKind> accessing_;
  AccessGate* gate_ = nullptr;
  std::vector<Granted> granted_;
  /// Pages for which a port has refused direct memory, so that it is not asked at every access:
  /// twice the number of the page, plus one where it was a store that asked.
  std::unordered_set<uint32_t> refused_;
};

}  // namespace capsoc::armv7m
