#pragma once

#include <cstdint>

#include "base/archive.h"

namespace capsoc::peripherals {

/// What the ADC front-end hands to the coprocessor, in one PCLK cycle.
struct SensorSample {
  int32_t u = 0;         ///< Q1.31, left-justified
  int32_t v = 0;         ///< Q1.31, left-justified
  bool clip = false;     ///< at least one channel was outside the range of the converter
  uint64_t number = 0;   ///< that its source gave it (AdcInput)
  unsigned channel = 0;  ///< of the coprocessor; a device of several channels saves it

  void visit(Archive& archive) {
    archive("u", u);
    archive("v", v);
    archive("clip", clip);
    archive("number", number);
  }
};

}  // namespace capsoc::peripherals
