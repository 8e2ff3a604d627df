#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <systemc>

#include "kit/clock_domain.h"
#include "kit/interrupt_line.h"
#include "kit/probe.h"
#include "kit/register_bank.h"
#include "peripherals/sensor_sample.h"

namespace capsoc::peripherals {

/// What the two signals of a sensor show at one instant.
struct AdcInput {
  double u;              ///< units of full scale; -1 to below 1 fit the converter
  double v;              ///< as u
  double angle_turns;    ///< true angle, if known
  bool has_truth;        ///< angle_turns is known
  uint64_t number = 0;   ///< of the source's; goes with the sample to its result
  unsigned channel = 0;  ///< of the coprocessor: the multiplexer in front of the converter
};

/// The ADC front-end: takes a sample of both channels every PERIOD cycles of PCLK, quantises it and
/// hands it on. Registers: models/registers/capsoc.svd, peripheral ADC.
class AdcFrontEnd : public kit::RegisterBank {
 public:
  /// The signal: sample `k` (from 0 at every start, which is the moment to rewind) at `t` seconds
  /// after sample 0. Nothing: the signal has ended.
  using Source = std::function<std::optional<AdcInput>(uint64_t k, double t)>;
  using Sink = std::function<void(const SensorSample&)>;

  /// `clock` is PCLK and must outlive the front-end. Without a source the signal ends with sample
  /// 0.
  AdcFrontEnd(const sc_core::sc_module_name& name, kit::ClockDomain& clock, Source source = {});

  kit::Register id;
  kit::Register ctrl;
  kit::Register status;
  kit::Register flags;
  kit::Register period;
  kit::Register bits;
  kit::Register data_u;
  kit::Register data_v;
  kit::Register count;

  kit::InterruptLine interrupt{*this, "interrupt"};

  void set_source(Source source) { source_ = std::move(source); }

  /// Called in the cycle of the sample, after the registers and the interrupt line have changed.
  void set_sink(Sink sink) { sink_ = std::move(sink); }
  /// Every sample after quantisation: its index since the start, and what the sink gets.
  kit::Probe<uint64_t, const SensorSample&> conversions;

  /// System reset: stops, all registers to their reset values.
  void reset() override;
  void visit(Archive& archive) override;
  void restored() override;

  /// The width of the converter that is fitted, 12 to 32 bits: what BITS holds after a reset.
  void fit_converter(uint32_t width);

 private:
  /// Samples since `index` are equally spaced, so their times follow from integers without adding
  /// up rounding.
  struct Segment {
    uint64_t index = 0;
    double seconds = 0;
    uint64_t period = 1;
    uint64_t hz = 1;
    void visit(Archive& archive);
  };

  void write_ctrl(uint32_t value);
  void write_period(uint32_t value);
  void write_bits(uint32_t value);
  void start();
  void stop();
  void take_sample();
  void convert(const AdcInput& input);
  void finish();
  void schedule();
  void update_interrupt();
  double sample_seconds() const;

  kit::ClockDomain& clock_;
  Source source_;
  Sink sink_;
  uint32_t fitted_bits_ = 32;
  uint64_t index_ = 0;       // of the next sample
  uint64_t next_cycle_ = 0;  // PCLK edge of the next sample
  Segment segment_;
  bool clock_changed_ = false;  // since the last sample
  sc_core::sc_time first_sample_;
  sc_core::sc_event sample_event_;
};

}  // namespace capsoc::peripherals
