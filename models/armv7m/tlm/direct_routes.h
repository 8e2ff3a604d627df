#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <systemc>

#include "kit/direct_route.h"
#include "kit/register_target.h"

namespace capsoc::armv7m {

/// The ways to registers that accesses have taken (kit::DirectRoute), each at one of two places
/// that the access chooses. An access ahead of the kernel on such a way needs no transaction.
class DirectRoutes {
 public:
  class Route {
   public:
    Route() = default;
    Route(const kit::DirectRoute& seen, uint32_t address, unsigned size)
        : target_(seen.target),
          is_steady_(seen.target->reads_steadily(seen.offset)),
          transfers_(seen.transfers),
          offset_(seen.offset),
          cycles_(seen.cycles),
          shift_(8 * (address & 3)),
          mask_(0xFFFFFFFFu >> (32 - 8 * size)) {}

    /// True if no listener would see the transactions that are left out.
    bool is_open() const { return transfers_ == nullptr || !transfers_->watched(); }
    unsigned cycles() const { return cycles_; }
    /// False: the target has notified no event.
    bool read(uint32_t& value, const sc_core::sc_time& time) const {
      const bool notified = target_->read_ahead(offset_, value, time);
      value = value >> shift_ & mask_;
      return notified;
    }
    /// kit::SteadyRead::steady, after a read; what was not is not asked again.
    bool is_steady() const { return is_steady_ && target_->reads_steadily(offset_); }
    /// False: not taken, and nothing is done.
    bool write(uint32_t value, const sc_core::sc_time& time) const {
      return target_->write_early(offset_, value << shift_, mask_ << shift_, time);
    }

   private:
    kit::RegisterTarget* target_ = nullptr;
    bool is_steady_ = false;
    const kit::TransferProbe* transfers_ = nullptr;
    uint32_t offset_ = 0;
    unsigned cycles_ = 0, shift_ = 0;
    uint32_t mask_ = 0;
  };

  /// Null: none is known.
  const Route* find(uint32_t address, unsigned size, bool write) const {
    const uint64_t access = access_of(address, size, write);
    const Pair& pair = pairs_[pair_of(access)];
    if (pair[0].access == access) return &pair[0].route;
    return pair[1].access == access ? &pair[1].route : nullptr;
  }
  /// After a transaction that told its way, or none.
  void note(uint32_t address, unsigned size, bool write, const kit::DirectRoute* seen) {
    const uint64_t access = access_of(address, size, write);
    Pair& pair = pairs_[pair_of(access)];
    for (Place& place : pair)
      if (place.access == access) place = {};
    if (seen == nullptr) return;
    if (pair[0].access != 0) pair[1] = pair[0];
    pair[0] = {access, Route(*seen, address, size)};
  }
  /// Those of a range of addresses.
  void forget(uint64_t first, uint64_t last) {
    for (Pair& pair : pairs_)
      for (Place& place : pair)
        if (place.access >> 8 >= first && place.access >> 8 <= last) place = {};
  }

 private:
  struct Place {
    uint64_t access = 0;
    Route route;
  };
  using Pair = std::array<Place, 2>;
  static constexpr unsigned pair_bits = 5;

  /// Never 0.
  static uint64_t access_of(uint32_t address, unsigned size, bool write) {
    return uint64_t{address} << 8 | size << 1 | (write ? 1 : 0);
  }
  static std::size_t pair_of(uint64_t access) {
    return access * 0x9E3779B97F4A7C15u >> (64 - pair_bits);
  }

  std::array<Pair, 1u << pair_bits> pairs_{};
};

}  // namespace capsoc::armv7m
