// A named stand-in for a device that the SoC has and the platform does not model.
#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <functional>
#include <string>
#include <systemc>
#include <tlm>

#include "kit/component.h"
#include "kit/direct_route.h"

namespace capsoc::bus {

/// Reads 0 and drops writes, of any length and at any address. The first access is reported as a
/// guest error with the program counter, so that "the firmware hangs" becomes "the firmware polls
/// the watchdog, which is not modelled". Debug accesses read 0 and are neither logged nor counted.
class Unimplemented : public sc_core::sc_module, public kit::Component, private kit::ZeroTarget {
 public:
  using CurrentPc = std::function<uint32_t()>;

  tlm_utils::simple_target_socket<Unimplemented> socket;

  /// `device` is the name for the log, `base` the bus address that stands for offset 0 in it.
  /// `current_pc` may be empty.
  Unimplemented(const sc_core::sc_module_name& name, std::string device, uint64_t base = 0,
                CurrentPc current_pc = {});

  uint64_t accesses() const { return accesses_; }
  /// The report of the first access, empty before it.
  const std::string& report() const { return report_; }

  /// A system reset changes nothing: the first access is still reported only once.
  void reset() override {}
  const char* component_name() const override { return basename(); }
  void visit(Archive& archive) override {
    archive("accesses", accesses_);
    archive("report", report_);
  }

 private:
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);
  void read_zero() override { ++accesses_; }
  unsigned transport_dbg(tlm::tlm_generic_payload& payload);
  void report_first(const tlm::tlm_generic_payload& payload);

  std::string device_;
  uint64_t base_;
  CurrentPc current_pc_;
  uint64_t accesses_ = 0;
  std::string report_;
};

}  // namespace capsoc::bus
