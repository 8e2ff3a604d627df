// A fault as a line says it: WHAT PLACE at WHEN [for SECONDS]. Knows no simulation.
//
//   flip cpu.r3[5] at 0.25s                 one bit, once
//   stuck1 COPROCESSOR.A1[3] at sample 1000 for 0.1s
//   flip rtl.u_datapath.u_q[7] at sample 500 cycle 40
//   lose sample at sample 500               sample, irq NAME
//   double sample at sample 500
//   lose clock at 1s for 0.01s
//   freeze sin at sample 500 for 0.1s       sin, cos
//   raise irq 12 at cycle 99
//   flip read COPROCESSOR.ANGLE[3] at 1s    the word of the next read, on its way
//   lose write COPROCESSOR.CTRL at 1s
//   fail read ADC.STATUS at 1s              read, write
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace capsoc::inject {

/// When a fault begins: the first instant at or after this one.
struct When {
  enum class Unit { time, cycle, instruction, sample };
  Unit unit = Unit::time;
  uint64_t value = 0;   ///< time: ps; sample: from 1, over all starts of the sensor
  uint64_t cycles = 0;  ///< of the clock since the sample
};

struct Fault {
  enum class Kind {
    flip,
    stuck0,
    stuck1,
    lose_sample,
    double_sample,
    lose_clock,
    freeze,
    lose_interrupt,
    raise_interrupt,
    lose_write,
    fail_access
  };
  /// Of an access of the processor to a device, on its way; none: in the place itself.
  enum class Way { none, read, write };
  Kind kind = Kind::flip;
  Way way = Way::none;
  std::string place;  ///< of a bit, an access; freeze: "sin" or "cos"; of an interrupt: its name
  unsigned bit = 0;   ///< of flip, stuck0 and stuck1
  When when;
  std::optional<uint64_t> duration;  ///< ps; without: of stuck bits, freeze: for ever; others: once
  std::string origin = {};           ///< begins error sentences: the option, or file and line

  /// A bit of a place: flip, stuck0, stuck1.
  bool is_of_bit() const { return kind <= Kind::stuck1; }
  bool is_stuck() const { return kind == Kind::stuck0 || kind == Kind::stuck1; }
};

/// What a fault of a bit makes of a value in which the bit has this number.
uint64_t with_bit(const Fault& fault, uint64_t value, unsigned bit);

/// An Error says what is wrong with the line, as the end of a sentence. `now`: when a fault of a
/// line without "at WHEN" begins; nothing: it has to have one.
Result<Fault> parse_fault(const std::string& line, const std::optional<When>& now = std::nullopt);
/// The line in its one form; parse_fault() gives the same fault.
std::string to_text(const Fault& fault);

/// Faults of a file's text, a line each; empty lines and what follows # do not count. An Error
/// names file and line.
Result<std::vector<Fault>> parse_faults(const std::string& file, const std::string& text);

}  // namespace capsoc::inject
