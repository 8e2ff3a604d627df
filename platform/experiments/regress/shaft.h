// A shaft in front of a coprocessor whose weights fit its sensor: samples by the turn.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/constants.h"
#include "base/fixed.h"
#include "coprocessor/register_map.h"
#include "regress/bench.h"

namespace capsoc::regress {

inline uint32_t q31_word(double value) {
  return static_cast<uint32_t>(fixed::to_q31(value));
}

struct ShaftSensor {
  double a1 = 0.6, a2 = 0.55, b1 = 0.1, b2 = -0.05, beta = 0.2;
};

class Shaft {
 public:
  Shaft(Bench& bench, uint32_t ctrl, double turns_a_sample, const ShaftSensor& sensor = {})
      : bench_(bench), sensor_(sensor) {
    bench.drain();
    bench.wait(2);
    bench.write(coprocessor::reg_ctrl, coprocessor::ctrl_srst);
    bench.write(coprocessor::reg_a1, q31_word(sensor.a1));
    bench.write(coprocessor::reg_a2, q31_word(sensor.a2));
    bench.write(coprocessor::reg_b1, q31_word(sensor.b1));
    bench.write(coprocessor::reg_b2, q31_word(sensor.b2));
    bench.write(
        coprocessor::reg_beta,
        static_cast<uint32_t>(static_cast<int64_t>(std::llround(sensor.beta / two_pi * 0x1p32))));
    bench.write(coprocessor::reg_cmd, coprocessor::cmd_load);
    bench.drain();
    bench.write_pair(coprocessor::reg_freq_lo, std::llround(std::ldexp(turns_a_sample, 48)));
    bench.write(coprocessor::reg_lock_threshold, ~0u);
    bench.write(coprocessor::reg_ctrl, ctrl | coprocessor::ctrl_adc);
  }

  // `n` samples, `turns` further each; the vector `scale` times as long as the weights say.
  void move(int n, double turns, double scale = 1, bool clip = false) {
    for (int i = 0; i < n && !bench_.failed(); ++i) {
      const double u = scale * sensor_.a1 * std::sin(angle_) + sensor_.b1;
      const double v = scale * sensor_.a2 * std::cos(angle_ + sensor_.beta) + sensor_.b2;
      bench_.sample(q31_word(u), q31_word(v), clip);
      bench_.wait(bench_.tick());
      angle_ += turns * two_pi;
    }
  }

  void read() {
    bench_.drain();
    for (uint32_t offset :
         {coprocessor::reg_turn_flags, coprocessor::reg_radius_max, coprocessor::reg_residue_max,
          coprocessor::reg_winding, coprocessor::reg_turn_samples, coprocessor::reg_turn_det,
          coprocessor::reg_status, coprocessor::reg_flags})
      bench_.read(offset);
    bench_.interrupt();
    bench_.write(coprocessor::reg_flags, coprocessor::flags_all);
  }

 private:
  Bench& bench_;
  ShaftSensor sensor_;
  double angle_ = 0.01;
};

}  // namespace capsoc::regress
