// Measures the length of one turn from the samples of one channel: the time between two rising
// crossings of the middle of its range. The hysteresis is an eighth of the range to both sides;
// crossings are interpolated linearly between samples. Any waveform works that rises through its
// middle once a turn, in at least 22 samples. A range below six times the largest step counts as
// noise; a turn of 22 samples has a range of seven times its largest step.
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
