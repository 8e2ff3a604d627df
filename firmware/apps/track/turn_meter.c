#include "turn_meter.h"

// A range of less than 1/64 of full scale is taken for noise.
enum { smallest_range = 1 << 25 };

static void extend_range(struct turn_meter* meter, int32_t u) {
  if (meter->samples == 0) meter->minimum = meter->maximum = meter->previous = u;
  if (u < meter->minimum) meter->minimum = u;
  if (u > meter->maximum) meter->maximum = u;
  const int64_t way = (int64_t)u - meter->previous;
  const uint32_t step = (uint32_t)(way < 0 ? -way : way);
  if (step > meter->step) meter->step = step;
}

static bool is_noise(const struct turn_meter* meter, int64_t range) {
  return range < smallest_range || range / 6 < meter->step;
}

// 1/256 sample; `u` is at or above the level, the sample before it below.
static uint64_t crossing_time(const struct turn_meter* meter, int64_t level, int32_t u) {
  const int64_t rise = (int64_t)u - meter->previous;
  const int64_t fraction = ((level - meter->previous) * 256 + rise / 2) / rise;
  return (uint64_t)(meter->samples - 1) * 256 + (uint64_t)fraction;
}

// Any level gives the length of the turn as long as both crossings have the same. So the level of
// the first crossing stays, unless the range outgrows it. Then that crossing was not one of the
// whole signal, and the measurement starts again.
static void drop_stale_crossing(struct turn_meter* meter, int64_t middle, int64_t range) {
  const int64_t shift = middle > meter->level ? middle - meter->level : meter->level - middle;
  if (!meter->has_crossing || shift <= range / 8) return;
  meter->has_crossing = false;
  meter->armed = false;
}

static uint64_t cross(struct turn_meter* meter, int64_t level, int32_t u) {
  const uint64_t time = crossing_time(meter, level, u);
  const uint64_t turn = meter->has_crossing ? time - meter->crossed_at : 0;
  meter->armed = false;
  meter->risen = false;
  meter->has_crossing = true;
  meter->level = (int32_t)level;
  meter->crossed_at = time;
  return turn;
}

uint64_t turn_meter_feed(struct turn_meter* meter, int32_t u) {
  extend_range(meter, u);
  const int64_t range = (int64_t)meter->maximum - meter->minimum;
  const int64_t middle = meter->minimum + range / 2;
  drop_stale_crossing(meter, middle, range);
  const int64_t level = meter->has_crossing ? meter->level : middle;
  uint64_t turn = 0;
  if (u > level + range / 8) meter->risen = true;
  if (is_noise(meter, range)) {
    meter->armed = false;
  } else if (u < level - range / 8) {
    meter->armed = meter->armed || !meter->has_crossing || meter->risen;
  } else if (meter->armed && u >= level) {
    turn = cross(meter, level, u);
  }
  meter->previous = u;
  ++meter->samples;
  return turn;
}
