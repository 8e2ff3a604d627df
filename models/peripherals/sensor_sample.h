#pragma once

#include <cstdint>

namespace capsoc::peripherals {

/// What the ADC front-end hands to the coprocessor, in one PCLK cycle.
struct SensorSample {
  int32_t u;  ///< Q1.31, left-justified
  int32_t v;  ///< Q1.31, left-justified
  bool clip;  ///< at least one channel was outside the range of the converter
};

}  // namespace capsoc::peripherals
