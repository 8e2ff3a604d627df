// What the processor of a board did in the recent past, while a client asks for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "armv7m/observer.h"
#include "service/activity_record.h"
#include "service/verb.h"
#include "soc/soc.h"

namespace capsoc::service {

/// Looks only, and costs nothing before begin().
class Activity final : private armv7m::Observer {
 public:
  Activity() = default;
  ~Activity() override { end(); }
  Activity(const Activity&) = delete;
  Activity& operator=(const Activity&) = delete;

  void attach(soc::Soc& soc) { soc_ = &soc; }
  /// Records from now on, for windows of this length (an index of ActivityRecord::windows) and
  /// others. Between two instructions. One that records continues.
  void begin(std::size_t window);
  void end();
  bool is_on() const { return is_on_; }
  /// The frequency of the processor's clock is another one from now on.
  void clock_changed();
  /// The one that was asked for last.
  std::size_t window() const { return window_; }
  /// For begin() or later, as the method processor.activity has it.
  Answer read() const;

 private:
  void note(uint64_t ps, bool is_asleep, unsigned entered = 0);
  uint64_t ps_of(uint64_t cycle) const;
  uint64_t parts(bool is_asleep) const;

  void issued(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void retired(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how,
               uint64_t since) override;
  void returned(const armv7m::Core& core, unsigned exception) override;
  void accessed(const armv7m::Core&, const armv7m::DirectAccess&) override {}
  void started(const armv7m::Core& core) override;

  soc::Soc* soc_ = nullptr;
  bool is_on_ = false;
  // An edge of the clock after its last change, its instant, and the period if it is a whole number
  // of picoseconds, else 0.
  uint64_t edge_ = 0, edge_ps_ = 0, period_ps_ = 0;
  std::size_t window_ = 0;
  ActivityRecord record_;
  std::function<void(bool)> other_;  ///< that listened to sleep before
};

}  // namespace capsoc::service
