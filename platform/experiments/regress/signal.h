// Samples of a sensor, and of things that are none.
#pragma once

#include <cstdint>

#include "regress/corner_words.h"

namespace capsoc::regress {

struct Sample {
  uint32_t u = 0, v = 0;  // Q1.31
  bool clip = false;
};

class Signal {
 public:
  /// Draws a kind of signal and its numbers.
  explicit Signal(Random& random);

  Sample next(Random& random);
  /// Turn per sample of a sensor signal, as a FREQ word (2^-48 turn).
  int64_t frequency() const { return frequency_; }

 private:
  enum class Kind { sensor, faint_sensor, noise, corners, steps, shuffled_sensor };

  Sample sensor(double turns) const;

  Kind kind_;
  double a1_, a2_, b1_, b2_, beta_, phi_;
  double turns_ = 0;  // of the shaft
  double ripple_ = 0;
  int64_t frequency_ = 0;
  Sample held_;
};

}  // namespace capsoc::regress
