#include "start_range.h"

static int32_t half_width(int32_t least, int32_t greatest) {
  return (int32_t)(((int64_t)greatest - least) / 2);
}

static int32_t middle(int32_t least, int32_t greatest) {
  return (int32_t)(((int64_t)greatest + least) / 2);
}

static uint32_t distance(int32_t one, int32_t other) {
  return one > other ? (uint32_t)one - (uint32_t)other : (uint32_t)other - (uint32_t)one;
}

static void follow_extremes(struct start_range* range, int32_t u, int32_t v) {
  if (u < range->u_least) {
    range->u_least = u;
    range->v_at_least = v;
  }
  if (u > range->u_greatest) {
    range->u_greatest = u;
    range->v_at_greatest = v;
  }
  if (v < range->v_least) range->v_least = v;
  if (v > range->v_greatest) range->v_greatest = v;
}

static bool is_closed(struct start_range* range, int32_t u, int32_t v) {
  const uint32_t width_u = distance(range->u_greatest, range->u_least);
  const uint32_t width_v = distance(range->v_greatest, range->v_least);
  if (width_u / 8 < range->u_step || width_v / 8 < range->v_step) return false;
  const uint32_t from_u = distance(u, range->u_first), from_v = distance(v, range->v_first);
  if (from_u > width_u / 4 || from_v > width_v / 4) range->away = true;
  return range->away && from_u < width_u / 8 && from_v < width_v / 8;
}

void start_range_feed(struct start_range* range, int32_t u, int32_t v) {
  if (range->samples == 0) {
    range->u_first = range->u_last = range->u_least = range->u_greatest = u;
    range->v_first = range->v_last = range->v_least = range->v_greatest = v;
    range->v_at_least = range->v_at_greatest = v;
  }
  follow_extremes(range, u, v);
  const uint32_t step_u = distance(u, range->u_last), step_v = distance(v, range->v_last);
  if (step_u > range->u_step) range->u_step = step_u;
  if (step_v > range->v_step) range->v_step = step_v;
  range->u_last = u;
  range->v_last = v;
  ++range->samples;
  if (range->turn == 0 && is_closed(range, u, v)) range->turn = range->samples;
}

// floor(sqrt(value)), bit by bit.
static uint32_t root(uint64_t value) {
  uint64_t result = 0;
  for (uint64_t bit = UINT64_C(1) << 62; bit != 0; bit >>= 2) {
    const uint64_t trial = result + bit;
    result >>= 1;
    if (value >= trial) {
      value -= trial;
      result += bit;
    }
  }
  return (uint32_t)result;
}

struct start_values start_range_values(const struct start_range* range) {
  struct start_values values;
  values.a1 = half_width(range->u_least, range->u_greatest);
  values.a2 = half_width(range->v_least, range->v_greatest);
  values.b1 = middle(range->u_least, range->u_greatest);
  values.b2 = middle(range->v_least, range->v_greatest);
  return values;
}

// V = a_v sin + b_v cos + c_v is a_v + c_v where U = a_u sin + c_u is greatest, and -a_v + c_v
// where it is least. The phase error is less than a quarter turn: b_v is positive.
void start_range_coefficients(const struct start_range* range, int32_t coefficients[6]) {
  const struct start_values start = start_range_values(range);
  const int64_t a2 = start.a2, most = a2 * 31 / 32;
  int64_t a_v = ((int64_t)range->v_at_greatest - range->v_at_least) / 2;
  if (a_v > most) a_v = most;
  if (a_v < -most) a_v = -most;
  coefficients[0] = start.a1;
  coefficients[1] = 0;
  coefficients[2] = start.b1;
  coefficients[3] = (int32_t)a_v;
  coefficients[4] = (int32_t)root((uint64_t)(a2 * a2 - a_v * a_v));
  coefficients[5] = start.b2;
}
