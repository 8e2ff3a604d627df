#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "armv7m/core.h"
#include "armv7m/tlm/polling_watch.h"

namespace capsoc::armv7m {

/// A completed bus access.
struct BusTransfer {
  uint32_t address, size, value, wait_cycles;
  bool operator==(const BusTransfer& other) const {
    return address == other.address && size == other.size && value == other.value &&
           wait_cycles == other.wait_cycles;
  }
};

/// Skips iterations of loops that only poll a device. Executes one iteration by single steps, then
/// skips all whole iterations that end before anything can happen. Also answers a repeated read of
/// the same status without an access. Independent of the kernel: the caller passes in how far the
/// core may go and whether the kernel has run. The core is not owned.
class PollingSkipper {
 public:
  explicit PollingSkipper(Core& core) : core_(core) {}

  /// Off: nothing is skipped, and every access is made. Initially on.
  void set_enabled(bool on) { enabled_ = on; }
  bool enabled() const { return enabled_; }

  /// Call before an access: the previous read is no longer valid.
  void forget_read() { holds_ = false; }
  /// Call after an access. `is_read`: a successful load; `steady`: side-effect-free, and stable
  /// until the kernel's next activity (kit::SteadyRead); `limit`: the cycle of that activity;
  /// `kernel_runs`: a number that changes whenever the kernel runs.
  void made(const BusTransfer& transfer, bool is_read, bool steady, uint64_t limit,
            uint64_t kernel_runs);
  /// The latest transfer, if the same read need not be repeated: the device declared it stable, and
  /// since then neither the kernel has run nor another access was made. Else null.
  const BusTransfer* repeats(uint32_t address, unsigned size, uint64_t kernel_runs) const {
    const bool same = holds_ && kernel_runs == kernel_runs_ && latest_->address == address &&
                      latest_->size == size;
    return same ? &*latest_ : nullptr;
  }
  /// Call instead of made() if that transfer was reused.
  void repeated(uint64_t limit) { note(*latest_, true, limit); }

  /// True if the program seems to poll, so that measure() is worth a call after this run of the
  /// core.
  bool seems_to_poll() const { return seems_to_poll_; }
  void clear() { seems_to_poll_ = false; }

  /// Skips whole iterations up to the cycle `limit`. Call after a read since which the kernel has
  /// not run. False, with nothing done, unless that read and the core's state are those of the
  /// iteration measured last.
  bool skip_known(uint64_t limit);
  /// Executes up to two iterations by single steps, before the cycle `until_cycle`. Empty: the
  /// program does not only wait. The caller lets the kernel catch up, and calls skip() if nothing
  /// has changed.
  std::optional<Turn> measure(uint64_t until_cycle);
  /// Skips whole iterations like the one measured, as long as its reads are stable.
  void skip(const Turn& turn) { core_.skip_turns(turn, steady_until_); }

 private:
  void note(const BusTransfer& transfer, bool steady, uint64_t limit);

  Core& core_;
  PollingWatch watch_;
  bool enabled_ = true;
  std::optional<BusTransfer> latest_;  // only a steady read is one of an iteration
  bool latest_steady_ = false;
  bool holds_ = false;  // it was a steady read, and no access has been made since
  uint64_t kernel_runs_ = 0;
  bool seems_to_poll_ = false;
  // While an iteration is measured
  bool measuring_ = false;
  uint64_t steady_until_ = 0;             // the cycle until which all its reads stay as they are
  std::array<uint64_t, 2> read_at_{};     // the cycles of the latest two reads
  std::optional<BusTransfer> only_read_;  // of the iteration measured last, if it has just one
};

}  // namespace capsoc::armv7m
