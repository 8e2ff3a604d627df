// Faults of the processor's reads and writes of device registers, on their way over the bus.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "armv7m/tlm/access_gate.h"
#include "base/result.h"
#include "inject/places.h"
#include "inject/stream_faults.h"

namespace capsoc::inject {

/// Bits of a word flipped or stuck, writes lost, accesses answered with an error. A fault waits for
/// its instant and then, armed, for the next access to its register.
class BusFaults final : private armv7m::AccessGate {
 public:
  /// The faults and the position outlive this.
  explicit BusFaults(const Position& position) : position_(position) {}
  ~BusFaults();
  BusFaults(const BusFaults&) = delete;
  BusFaults& operator=(const BusFaults&) = delete;
  static bool takes(const Fault& fault) { return fault.way != Fault::Way::none; }
  /// An Error is the end of a sentence.
  std::optional<Error> add(Injected& injected, const Places& places);

  /// Those that are not armed yet.
  std::vector<const Injected*> waiting() const;
  /// Between two instructions: arms those whose instant has come, and notes the number of the
  /// instruction of the first access that a fault changed.
  void pause();

 private:
  struct OnBus {
    Injected* injected;
    uint32_t address;  ///< of the register's word
    bool is_armed = false;
    bool has_acted = false;  ///< since the last pause(), for the first time
  };
  Fate sent(const Access& access, uint32_t& value) override;
  void returned(const Access& access, uint32_t& value) override;
  bool is_acting(OnBus& each, const Access& access) const;
  void change(OnBus& each, const Access& access, uint32_t& value) const;
  void apply(OnBus& each, uint32_t before, uint32_t after) const;

  const Position& position_;
  std::vector<OnBus> faults_;
};

}  // namespace capsoc::inject
