#include "sensor/signal_config.h"

namespace capsoc::sensor {

const char* name_of(MotionKind kind) {
  switch (kind) {
    case MotionKind::constant:
      return "constant";
    case MotionKind::ripple:
      return "ripple";
    case MotionKind::shuffled:
      return "shuffled";
    case MotionKind::walk:
      return "walk";
    case MotionKind::swing:
      return "swing";
    case MotionKind::recorded:
      return "recorded";
  }
  return "unknown";
}

Description describe(const SignalConfig& config) {
  Description description;
  description.name = config.name;
  description.origin = config.origin;
  description.motion = config.motion.kind;
  description.a1 = config.a1;
  description.a2 = config.a2;
  description.b1 = config.b1;
  description.b2 = config.b2;
  description.beta = config.beta;
  description.phi = config.phi;
  const bool turns = config.motion.kind == MotionKind::constant ||  //
                     config.motion.kind == MotionKind::ripple;
  if (turns) {
    description.frequency_hz = config.motion.frequency_hz;
    description.reference_hz = config.motion.reference_hz.value_or(config.motion.frequency_hz);
  }
  description.sample_rate_hz = config.sample_rate_hz;
  description.adc_bits = config.adc_bits;
  description.samples = config.samples;
  return description;
}

}  // namespace capsoc::sensor
