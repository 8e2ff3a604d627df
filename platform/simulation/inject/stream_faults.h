// Faults between the parts of the chip: of samples on their way from the converter to the
// coprocessor, and of interrupt lines on their way to the processor.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "inject/fault.h"
#include "peripherals/sensor_sample.h"
#include "results/results.h"
#include "soc/soc.h"

namespace capsoc::inject {

/// A fault with its outcome so far.
struct Injected {
  Fault fault;
  run::FaultOutcome outcome;
  bool is_over = false;                 ///< it does nothing any more
  std::optional<sc_core::sc_time> end;  ///< of one that lasts, from when it began
};

/// Where the run is, as faults count it.
struct Position {
  soc::Soc& soc;
  uint64_t sample = 0;     ///< number of the newest one that was converted
  uint64_t converted = 0;  ///< the clock edge of that

  bool reached(const When& when) const;
  /// Notes in `outcome` that the fault acts here, the first time.
  void note(Injected& injected, uint64_t before, uint64_t after) const;
};

/// Samples lost, doubled, frozen, with bits flipped or stuck. They act after the converter's
/// registers.
class SampleFaults {
 public:
  /// The faults and the position outlive this.
  explicit SampleFaults(const Position& position) : position_(position) {}
  /// Whether it is of this kind.
  static bool takes(const Fault& fault);
  /// An Error is the end of a sentence.
  std::optional<Error> add(Injected& injected);
  /// Puts itself between converter and coprocessor, if it has faults.
  void connect(soc::Soc& soc);
  /// After a checkpoint was loaded.
  void restored(soc::Soc& soc);

 private:
  void pass(peripherals::SensorSample sample);
  bool is_acting(Injected& injected) const;
  void change(Injected& injected, int32_t& word, int32_t last) const;

  const Position& position_;
  std::vector<Injected*> faults_;
  std::optional<peripherals::SensorSample>
      last_;  ///< as it was passed on; a frozen channel keeps that
};

/// Interrupts lost, each from its rise to its fall.
class InterruptFaults {
 public:
  explicit InterruptFaults(const Position& position) : position_(position) {}
  /// An Error is the end of a sentence.
  std::optional<Error> add(Injected& injected);
  void connect(soc::Soc& soc);

 private:
  struct Lost {
    Injected* injected;
    unsigned line;
  };
  bool passes(unsigned line, bool level);

  const Position& position_;
  std::vector<Lost> lost_;
};

/// The processor's line of "12", "coprocessor" or "uart0.rx". An Error is the end of a sentence.
Result<unsigned> interrupt_line(const std::string& name);

}  // namespace capsoc::inject
