#pragma once

#include <cstdint>
#include <vector>

#include "base/random.h"
#include "sensor/signal_config.h"

namespace capsoc::sensor {

/// a * b modulo 1, in [0, 1]: the whole turns are taken off before anything is rounded, so that the
/// fraction of a large product keeps full double precision.
double product_modulo_turn(double a, double b);

/// x modulo 1 in [0, 1).
double modulo_turn(double x);

/// Where the shaft is, in turns, without phi.
class Motion {
 public:
  explicit Motion(const MotionConfig& config);

  /// In [0, 1). A walk takes a step for every sample between the last one asked for and k (from the
  /// start when k lies before it); every other motion is computed directly.
  double angle(uint64_t k, double t_seconds);

  void rewind();

 private:
  double turned(double t_seconds) const;
  double walked(uint64_t k);
  double ran(double t_seconds) const;

  MotionConfig config_;
  RandomSequence random_;
  uint64_t walk_index_ = 0;
  double walk_angle_ = 0.0;
  std::vector<double> at_points_;  ///< of a profile: the angle at each of its points, in [0, 1)
};

}  // namespace capsoc::sensor
