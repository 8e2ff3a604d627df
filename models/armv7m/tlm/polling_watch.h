// Notices a program that reads the same status again and again.
#pragma once

#include <algorithm>
#include <cstdint>

namespace capsoc::armv7m {

/// Asked after every access to the bus. That a program reads the same again is no proof that it
/// polls; it says that it is worth looking (Core::repeat_turn). Where that was in vain, the watch
/// is more patient the next time.
class PollingWatch {
 public:
  /// `steady`: it was a read, and may be repeated for nothing (kit::SteadyRead).
  bool is_worth_a_look(uint32_t address, uint32_t value, bool steady) {
    const Read read{steady, address, value};
    if (steady && read == latest_) return ++times_ >= patience_;
    latest_ = read;
    times_ = 0;
    // A loop that waited last time has the same answer to wait for.
    return steady && read == waited_for_ && patience_ == least_patience;
  }
  /// Result of the measurement. After a skip less than an iteration is left, so the next read is no
  /// reason for another measurement.
  void looked(bool polls) {
    times_ = polls ? -1 : 0;
    patience_ = polls ? least_patience : std::min(2 * patience_, most_patience);
    if (polls) waited_for_ = latest_;
  }

 private:
  struct Read {
    bool steady = false;
    uint32_t address = 0, value = 0;
    bool operator==(const Read& other) const {
      return steady == other.steady && address == other.address && value == other.value;
    }
  };
  static constexpr int least_patience = 1, most_patience = 1024;
  Read latest_, waited_for_;
  int times_ = 0, patience_ = least_patience;
};

}  // namespace capsoc::armv7m
