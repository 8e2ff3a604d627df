#pragma once

#include <cstdint>

#include "sensor/signal_config.h"

namespace capsoc::accuracy {

/// One run of the program `follow` on the coprocessor's model: its decisions are the firmware's
/// own (firmware/apps/follow), only the registers are written from here.
struct FollowingRun {
  sensor::SignalConfig signal;  ///< its adc_bits is the converter's width
  double duration_s = 60.0;
  double longest_turn_s = 20.0;  ///< slower turns are not learnt
};

/// "After the lock": after the sixth good turn of learning.
struct FollowingOutcome {
  bool locked = false;
  double locked_s = 0.0;
  double error_deg = 0.0;        ///< largest |ANGLE - true angle| after the lock, all samples
  double end_error_deg = 0.0;    ///< the same over the last second
  double frozen_part = 0.0;      ///< share of the samples after the lock in which nothing is learnt
  uint32_t turns = 0;            ///< learnt after the lock
  double longest_blind_s = 0.0;  ///< from the end of one of them to that of the next, at most
  bool clipped = false;
};

FollowingOutcome follow(const FollowingRun& run);

}  // namespace capsoc::accuracy
