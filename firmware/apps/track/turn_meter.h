// Measures the length of one turn from the samples of one channel: the time between two rising
// crossings of the middle of its range, with a hysteresis of an eighth of the range to both sides
// and linear interpolation between samples. Any waveform that rises through its middle once a turn
// will do, in at least 22 samples. As long as the range is below six times the largest step it may
// be noise (that of a turn of 22 samples is seven times).
#ifndef CAPSOC_TURN_METER_H
#define CAPSOC_TURN_METER_H

#include <stdbool.h>
#include <stdint.h>

struct turn_meter {
  uint32_t samples;
  int32_t minimum, maximum, previous;
  uint32_t step;        // the largest from one sample to the next
  int32_t level;        // of the first crossing, for the second one as well
  uint64_t crossed_at;  // 1/256 sample
  bool armed;           // the signal was below the level by the hysteresis
  bool risen;           // it was above by as much since the last crossing
  bool has_crossing;
};

// Starts as {0}. Returns the length of a turn in 1/256 sample once it is known, 0 before.
uint64_t turn_meter_feed(struct turn_meter* meter, int32_t u);

#endif
