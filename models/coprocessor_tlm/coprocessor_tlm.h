#pragma once

#include <cstdint>
#include <functional>
#include <systemc>
#include <utility>

#include "coprocessor/coprocessor.h"
#include "peripherals/sensor_sample.h"
#include "tlm/clock_domain.h"
#include "tlm/interrupt_line.h"
#include "tlm/register_target.h"

namespace capsoc::coprocessor {

/// The coprocessor on the bus: gives the model its cycle numbers and turns its next event into one
/// notification. Registers: models/registers/capsoc.svd, peripheral COPROCESSOR; words only,
/// anything else is an address error.
class CoprocessorTlm : public tlm_util::RegisterTarget {
 public:
  /// Runs once for every sample, in the cycle in which its results become visible and before the
  /// interrupt line follows. The first argument is that cycle.
  using ResultObserver = std::function<void(uint64_t cycle, const Nodes& nodes)>;

  /// `clock` is PCLK and must outlive the coprocessor.
  CoprocessorTlm(const sc_core::sc_module_name& name, tlm_util::ClockDomain& clock,
                 Options options = {});

  tlm_util::InterruptLine interrupt;

  /// The sink of the ADC stream, at the present instant. The model ignores it while CTRL.ADC is 0.
  /// Returns whether the sample was latched.
  bool sample(const peripherals::SensorSample& sample);

  /// System reset: power-on state; time goes on.
  void reset();

  void set_result_observer(ResultObserver observer) { observer_ = std::move(observer); }

  const Coprocessor& core() const { return core_; }

 protected:
  bool read_word(uint32_t offset, uint32_t& value, bool debug) override;
  bool write_word(uint32_t offset, uint32_t value, uint32_t lanes) override;

 private:
  uint64_t present_cycle();
  void catch_up();
  void follow();

  tlm_util::ClockDomain& clock_;
  Coprocessor core_;
  ResultObserver observer_;
  uint64_t last_cycle_ = 0;  // the model's time, which never goes back
  sc_core::sc_event event_;
};

}  // namespace capsoc::coprocessor
