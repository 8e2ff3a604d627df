#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <systemc>
#include <utility>

#include "coprocessor/coprocessor.h"
#include "coprocessor/device.h"
#include "coprocessor/tlm/device_clock.h"
#include "kit/clock_domain.h"
#include "kit/interrupt_line.h"
#include "kit/probe.h"
#include "kit/register_target.h"
#include "peripherals/sensor_sample.h"

namespace capsoc::coprocessor {

/// The coprocessor on the bus: gives its device (model, RTL or both) the cycle numbers and turns
/// the device's next event into one notification. Registers: models/registers/capsoc.svd,
/// peripheral COPROCESSOR; words only, anything else is an address error.
///
/// A sample or a write that arrives in the interval after edge n waits in a latch and acts at edge
/// n + 1, the sample first; a read shows the state that edge n left. So the order in which SystemC
/// runs its processes at an instant does not matter.
class CoprocessorTlm : public kit::RegisterTarget {
 public:
  /// `clock` is PCLK and must outlive the coprocessor.
  CoprocessorTlm(const sc_core::sc_module_name& name, kit::ClockDomain& clock,
                 std::unique_ptr<Device> device);
  /// With the model as its device.
  CoprocessorTlm(const sc_core::sc_module_name& name, kit::ClockDomain& clock, Options options = {})
      : CoprocessorTlm(name, clock, std::make_unique<Coprocessor>(options)) {}

  kit::InterruptLine interrupt{*this, "interrupt"};

  /// The sink of the ADC stream, at the present instant. The device ignores it while CTRL.ADC is 0.
  void sample(const peripherals::SensorSample& sample);

  /// System reset: power-on state; time continues.
  void reset() override;
  void visit(Archive& archive) override;
  void restored() override { follow(); }

  /// The results of every sample, in the cycle in which they become visible and before the
  /// interrupt line follows: that cycle, all nodes, and the number of the sample (SensorSample; 0:
  /// software wrote it).
  kit::Probe<uint64_t, const Nodes&, uint64_t> results;
  /// Every sample at the edge that takes or drops it: the cycle, whether it was taken, its number.
  kit::Probe<uint64_t, bool, uint64_t> samples;

  Device& device() { return *device_; }

  /// As Device::change_idle(), at the present instant. Also false while a sample or a write waits
  /// at the pins.
  bool change_idle(const Device::IdleChange& change);
  /// Call after the device was changed past this object, at the present instant: plans its next
  /// event and drives the interrupt line.
  void device_changed() { follow(); }

  /// Faults of the clock, at the present instant. lose_clock_edge(): the next edge does not come.
  /// stop_clock(): none comes until start_clock(); stops may be nested. A sample or a write that is
  /// on the pins at an edge that does not come is lost; reads show the state as it stands.
  void lose_clock_edge();
  void stop_clock();
  void start_clock();
  /// Whether results still come later than without such a fault: until the pipeline is empty.
  bool is_behind_clock();

  /// When the pipeline may be empty and nothing waits at the pins: to be asked again then. Nothing:
  /// it is so now.
  std::optional<sc_core::sc_time> quiet_at() const;

 protected:
  bool read_word(uint32_t offset, uint32_t& value, bool debug) override;
  bool write_word(uint32_t offset, uint32_t value, uint32_t lanes) override;

 private:
  struct Write {
    uint32_t offset = 0, value = 0;
    void visit(Archive& archive) {
      archive("offset", offset);
      archive("value", value);
    }
  };

  /// A sample in the device.
  struct Taken {
    uint64_t edge = 0, number = 0;
    void visit(Archive& archive) {
      archive("edge", edge);
      archive("number", number);
    }
  };

  void take(uint64_t edge);
  uint64_t number_of(const Nodes& nodes);
  void catch_up();
  void run_to(uint64_t cycle);
  void pass(uint64_t edge);
  void begin_access();
  void follow();
  bool waiting() const { return sample_ || write_; }
  void drop_inputs();

  DeviceClock clock_;
  std::unique_ptr<Device> device_;
  uint64_t interval_ = 0;  // the device has passed this edge; never goes back
  // What acts at edge interval_ + 1.
  std::optional<peripherals::SensorSample> sample_;
  std::optional<Write> write_;
  std::optional<uint64_t>
      accessed_;  // the interval of the last access: the bus carries one in each
  uint64_t commits_ = 0;
  std::deque<Taken>
      taken_;  // in order; those that a soft reset lost are in it until a later result
  sc_core::sc_event event_;
};

}  // namespace capsoc::coprocessor
