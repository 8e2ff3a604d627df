// A coprocessor with a sensor in front of it, for tests: signals of Eq (5) in double, samples once
// per `period` cycles, parameters and angle back in double.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "base/fixed.h"
#include "coprocessor/coprocessor.h"

namespace capsoc::coprocessor::test {

constexpr double tau = 6.283185307179586476925;

struct Sensor {
  double a1 = 0.6079, a2 = 0.6228, b1 = 0.1336, b2 = 0.1831, beta = 0.0629, phi = 0.0876;
};

inline double turns_to_radians(uint32_t angle) {
  return static_cast<double>(static_cast<int32_t>(angle)) / 4294967296.0 * tau;
}

// Distance of two angles in degrees, 0 .. 180. Both in radians.
inline double distance_degrees(double a, double b) {
  return std::fabs(std::remainder(a - b, tau)) / tau * 360;
}

class Bench {
 public:
  explicit Bench(const Options& options = {}) : dut(options) {}

  void write(uint32_t offset, uint32_t value) { dut.write(cycle, offset, value); }
  uint32_t read(uint32_t offset) { return dut.read(cycle, offset, false).value; }

  void start(uint32_t ctrl, double turns_per_sample, uint32_t step) {
    set_frequency(turns_per_sample);
    for (uint32_t r = reg_step_au; r <= reg_step_cv; r += 4) write(r, step);
    write(reg_ctrl, ctrl | ctrl_adc);
  }

  void set_frequency(double turns_per_sample) {
    const auto word = static_cast<int64_t>(std::llround(std::ldexp(turns_per_sample, 48)));
    write(reg_freq_lo, static_cast<uint32_t>(word & 0xFFFF));
    write(reg_freq_hi, static_cast<uint32_t>(word >> 16));
  }

  // One sample of the sensor with its shaft (less phi) at `angle` radians; returns with the results
  // committed.
  void sample(const Sensor& s, double angle) {
    cycle += period;
    const double u = s.a1 * std::sin(angle + s.phi) + s.b1;
    const double v = s.a2 * std::cos(angle + s.phi + s.beta) + s.b2;
    const bool clip = std::fabs(u) > 1 || std::fabs(v) > 1;
    dut.submit(cycle, fixed::to_q31(u), fixed::to_q31(v), clip);
    dut.advance(cycle + latency_cycles);
  }

  double angle() const { return turns_to_radians(static_cast<uint32_t>(dut.nodes().angle)); }

  // a1, a2, b1, b2, beta, phi in the order and units of Sensor.
  std::array<double, 6> parameters() const {
    const Nodes& n = dut.nodes();
    return {fixed::from_q31(n.a1),
            fixed::from_q31(n.a2),
            fixed::from_q31(n.b1),
            fixed::from_q31(n.b2),
            turns_to_radians(static_cast<uint32_t>(n.beta)),
            turns_to_radians(static_cast<uint32_t>(n.phi))};
  }

  Coprocessor dut;
  uint64_t cycle = 0;
  uint64_t period = 100000;
};

// Largest relative deviation of the six identified parameters from the sensor's. An angle in (or
// near) zero is compared absolutely, with unit 0.1 rad.
inline std::array<double, 6> deviations(const std::array<double, 6>& found, const Sensor& s) {
  const std::array<double, 6> truth = {s.a1, s.a2, s.b1, s.b2, s.beta, s.phi};
  std::array<double, 6> result{};
  for (size_t i = 0; i < 6; ++i) {
    const double error = i < 4 ? found[i] - truth[i] : std::remainder(found[i] - truth[i], tau);
    result[i] = std::fabs(error) / std::max(std::fabs(truth[i]), i < 4 ? 1e-3 : 0.01);
  }
  return result;
}

}  // namespace capsoc::coprocessor::test
