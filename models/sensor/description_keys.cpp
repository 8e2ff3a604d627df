#include "sensor/description_keys.h"

namespace capsoc::sensor {

std::string DescriptionKey::name() const {
  const std::string in = table;
  return in.empty() || in == "signal" || in == "sampling" ? key : in + "." + key;
}

const std::vector<DescriptionKey>& description_keys() {
  using Kind = DescriptionKey::Kind;
  static const std::vector<DescriptionKey> keys = {
      {"", "name", Kind::text, "name of the signal"},
      {"", "origin", Kind::text, "where it comes from"},
      {"sampling", "rate_hz", Kind::number, "rate that it is meant for, 1e-3 .. 1e7 Hz"},
      {"sampling", "samples", Kind::integer, "length, 1 .. 1e12"},
      {"signal", "a1", Kind::number, "amplitude of U, full scale, 1e-6 .. 10"},
      {"signal", "a2", Kind::number, "amplitude of V, full scale, 1e-6 .. 10"},
      {"signal", "b1", Kind::number, "offset of U, full scale, -10 .. 10"},
      {"signal", "b2", Kind::number, "offset of V, full scale, -10 .. 10"},
      {"signal", "beta_rad", Kind::number, "phase shift of V, rad, -2 pi .. 2 pi"},
      {"signal", "phi_rad", Kind::number, "initial angle, rad, -2 pi .. 2 pi"},
      {"motion", "kind", Kind::text, "constant, ripple, shuffled, walk, swing or profile"},
      {"motion", "frequency_hz", Kind::number, "constant, ripple: speed, negative backwards"},
      {"motion", "reference_hz", Kind::number, "constant, ripple: what firmware assumes"},
      {"motion", "reverse_at_s", Kind::number, "constant, ripple: back from then on, s"},
      {"motion", "ripple_amplitude", Kind::number, "ripple: share of the speed, 0 .. 1"},
      {"motion", "ripple_hz", Kind::number, "ripple: frequency"},
      {"motion", "seed", Kind::integer, "shuffled, walk"},
      {"motion", "step_turns", Kind::number, "walk: deviation of a step, 0 .. 1"},
      {"motion", "swing_hz", Kind::number, "swing: frequency"},
      {"motion", "amplitude_turns", Kind::number, "swing: 0 .. 1000"},
      {"motion", "centre_turns", Kind::number, "swing: -1 .. 1"},
      {"motion", "speeds", Kind::list, "profile: [[0, Hz], [s, Hz], ...], lines between them"},
      {"drift", "a1_per_s", Kind::number, "of the amplitude a second, -1 .. 1"},
      {"drift", "a2_per_s", Kind::number, "of the amplitude a second, -1 .. 1"},
      {"drift", "b1_per_s", Kind::number, "of the amplitude a second, -1 .. 1"},
      {"drift", "b2_per_s", Kind::number, "of the amplitude a second, -1 .. 1"},
      {"drift", "beta_rad_per_s", Kind::number, "rad a second, -1 .. 1"},
      {"drift", "until_s", Kind::number, "a straight course until then, s; or period_s"},
      {"drift", "period_s", Kind::number, "a sine as course, whose steepest slope the rates are"},
      {"noise", "sigma", Kind::number, "Gaussian, full scale, 0 .. 10; or peak"},
      {"noise", "peak", Kind::number, "largest value in the record, of each amplitude, 0 .. 10"},
      {"noise", "record_samples", Kind::integer, "with peak: 1 .. 1e7"},
      {"noise", "seed", Kind::integer, "of the noise"},
      {"speed_disturbance", "scale", Kind::number, "the SoC paper's Eq (22), 0 .. 1"},
      {"speed_disturbance", "record_samples", Kind::integer, "1 .. 1e7"},
      {"speed_disturbance", "seed", Kind::integer, "of the disturbance"},
  };
  return keys;
}

std::vector<std::string> motion_keys(MotionKind kind) {
  switch (kind) {
    case MotionKind::constant:
      return {"kind", "frequency_hz", "reference_hz", "reverse_at_s"};
    case MotionKind::ripple:
      return {"kind",         "frequency_hz",     "reference_hz",
              "reverse_at_s", "ripple_amplitude", "ripple_hz"};
    case MotionKind::shuffled:
      return {"kind", "seed"};
    case MotionKind::walk:
      return {"kind", "seed", "step_turns"};
    case MotionKind::swing:
      return {"kind", "swing_hz", "centre_turns", "amplitude_turns"};
    case MotionKind::profile:
      return {"kind", "speeds"};
    case MotionKind::recorded:
      break;
  }
  return {"kind"};
}

std::optional<MotionKind> motion_kind(const std::string& word) {
  for (const MotionKind kind : {MotionKind::constant, MotionKind::ripple, MotionKind::shuffled,
                                MotionKind::walk, MotionKind::swing, MotionKind::profile})
    if (word == name_of(kind)) return kind;
  return std::nullopt;
}

}  // namespace capsoc::sensor
