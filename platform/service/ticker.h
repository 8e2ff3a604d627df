#pragma once

#include <csignal>
#include <cstdint>
#include <ctime>
#include <optional>

#include "session/simulation.h"

namespace capsoc::service {

/// Processor time of this process.
uint64_t processor_time_ns();

/// Interrupts the simulation of this process now and then by its processor time, so that a snapshot
/// can be taken. When that is, the host decides; it changes nothing in the simulation.
class Ticker {
 public:
  /// The simulation must outlive it. One of them a process.
  explicit Ticker(run::Simulation& simulation);
  ~Ticker();
  Ticker(const Ticker&) = delete;
  Ticker& operator=(const Ticker&) = delete;

  void set(bool on);
  /// Whether an interval has passed since this was asked last.
  bool take();
  /// What was done at a tick took so long; the next interval is in proportion.
  void took(uint64_t ns);

 private:
  std::optional<timer_t> timer_;  // none: the system has none left, and nothing ticks
  uint64_t interval_ns_;
};

}  // namespace capsoc::service
