// What ends a run besides its program.
#pragma once

#include <chrono>
#include <systemc>

#include "host/end_signals.h"

namespace capsoc::run {

/// The host's reasons to end a run: a signal, or its own time.
class HostLimit {
 public:
  /// 0 seconds: no limit.
  explicit HostLimit(double seconds) : seconds_(seconds) {}
  double elapsed_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  bool reached() {
    out_of_time_ = seconds_ > 0 && elapsed_s() > seconds_;
    return out_of_time_ || host::noted_signal() != 0;
  }
  /// As it was when it was last asked.
  bool out_of_time() const { return out_of_time_; }

 private:
  double seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool out_of_time_ = false;
};

/// Ends the simulation at a simulated time, whatever the processor does.
class Limit : public sc_core::sc_module {
 public:
  Limit(const sc_core::sc_module_name& name, double seconds) : sc_module(name) {
    SC_HAS_PROCESS(Limit);
    if (seconds <= 0) return;
    SC_METHOD(expire);
    dont_initialize();
    sensitive << event_;
    event_.notify(sc_core::sc_time(seconds, sc_core::SC_SEC));
  }
  bool expired() const { return expired_; }

 private:
  void expire() {
    expired_ = true;
    sc_core::sc_stop();
  }
  sc_core::sc_event event_;
  bool expired_ = false;
};

}  // namespace capsoc::run
