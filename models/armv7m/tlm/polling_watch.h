// Detects a program that reads the same status repeatedly.
#pragma once

#include <algorithm>
#include <cstdint>

namespace capsoc::armv7m {

/// Called after every bus access. A repeated read does not prove that a program polls, but makes a
/// measurement worthwhile (Core::repeat_turn). After a failed measurement more repetitions are
/// required.
class PollingWatch {
 public:
  /// `steady`: the access was a read that is side-effect-free and stable (kit::SteadyRead).
  bool is_worth_a_look(uint32_t address, uint32_t value, bool steady) {
    const Read read{steady, address, value};
    if (steady && read == latest_) return ++times_ >= patience_;
    latest_ = read;
    times_ = 0;
    // A loop that polled last time waits for a change of the same answer.
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
