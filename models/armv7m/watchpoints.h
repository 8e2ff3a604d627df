#pragma once

#include <cstdint>
#include <vector>

#include "armv7m/core_context.h"
#include "armv7m/pending_exceptions.h"

namespace capsoc::armv7m {

/// A debugger's watchpoint: loads and stores of instructions to a range.
struct Watchpoint {
  uint32_t address = 0, size = 0;
  bool on_read = false, on_write = false;

  bool operator==(const Watchpoint& other) const {
    return address == other.address && size == other.size && on_read == other.on_read &&
           on_write == other.on_write;
  }
};
/// The access that ended a run.
struct WatchHit {
  Watchpoint watchpoint;
  uint32_t address = 0;  ///< first watched byte that was touched
};

/// The data accesses that end a run or raise a debug event: a debugger's watchpoints and the
/// comparators of the DWT. After a change the caller must call MemoryAccess::views_changed():
/// accesses to a watched page take the slow path.
class Watchpoints {
 public:
  /// Nothing is owned.
  Watchpoints(CoreContext& context, PendingExceptions& pending)
      : context_(context), pending_(pending) {}

  /// Of a debugger: ends run() after the instruction that made such an access.
  void add(const Watchpoint& watchpoint) { watchpoints_.push_back(watchpoint); }
  /// False: there is none like it.
  bool remove(const Watchpoint& watchpoint);
  const WatchHit& hit() const { return watch_hit_; }
  /// True if the debugger or the program watches data: anywhere, or loads or stores in the page of
  /// an address.
  bool watches_data() const;
  bool watches_page(uint32_t address, bool write) const;
  /// Records an access to a watched byte; the run then ends after the present instruction.
  bool watched(uint32_t address, unsigned size, bool write);

 private:
  CoreContext& context_;
  PendingExceptions& pending_;
  std::vector<Watchpoint> watchpoints_;
  WatchHit watch_hit_;
};

}  // namespace capsoc::armv7m
