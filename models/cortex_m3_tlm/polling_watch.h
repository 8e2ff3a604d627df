// Notices a program that reads the same status again and again.
#pragma once

#include <algorithm>
#include <cstdint>

namespace capsoc::cortex_m3 {

/// Asked behind every access to the bus. That a program is at the same place again is no proof that
/// it polls; it says that it is worth looking (Core::repeat_turn). Where that was in vain, the
/// watch is more patient the next time.
class PollingWatch {
 public:
  /// `place`: the program counter; `steady`: the access was a read that may be repeated for nothing
  /// (kit::SteadyRead).
  bool is_worth_a_look(uint32_t place, bool steady) {
    if (!steady || place != place_) {
      place_ = place;
      times_ = 0;
      return false;
    }
    return ++times_ >= patience_;
  }
  /// What the look came to.
  void looked(bool polls) {
    times_ = 0;
    patience_ = polls ? least_patience : std::min(2 * patience_, most_patience);
  }

 private:
  static constexpr unsigned least_patience = 1, most_patience = 1024;
  uint32_t place_ = 0;
  unsigned times_ = 0, patience_ = least_patience;
};

}  // namespace capsoc::cortex_m3
