// A limit of simulated time.
#pragma once

#include <systemc>

namespace capsoc::run {

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
