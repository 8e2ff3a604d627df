#include "sensor_change.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define NOTABLE 0.02
#define HALF_TURN_RAD 3.141592653589793

static char sentence[160];

static void add(const char* text) {
  strncat(sentence, text, sizeof sentence - 1 - strlen(sentence));
}

// 0 to 9999.
static void add_percent(double share) {
  char digits[6];
  size_t at = sizeof digits;
  digits[--at] = '\0';
  unsigned value = (unsigned)fmin(9999, share * 100 + 0.5);
  do {
    digits[--at] = (char)('0' + value % 10);
    value /= 10;
  } while (value != 0);
  add(&digits[at]);
  add(" %");
}

// Beta beyond a quarter turn is the same ellipse, passed through the other way round.
static double canonical(double beta) {
  if (beta > HALF_TURN_RAD / 2) return HALF_TURN_RAD - beta;
  if (beta < -HALF_TURN_RAD / 2) return -HALF_TURN_RAD - beta;
  return beta;
}

const char* sensor_change(const struct signal_shape* shape,
                          const struct coprocessor_parameters* parameters) {
  struct signal_ellipse now;
  if (signal_shape_kind(shape, &now) != signal_elliptic) return NULL;
  const double a1 = parameters->a1 * 0x1p-31, a2 = parameters->a2 * 0x1p-31;
  const double gain_u = now.a1 / a1, gain_v = now.a2 / a2;
  const double offset_u = (now.b1 - parameters->b1 * 0x1p-31) / a1;
  const double offset_v = (now.b2 - parameters->b2 * 0x1p-31) / a2;
  const double phase = now.beta - canonical((int32_t)parameters->beta * (HALF_TURN_RAD * 0x1p-31));
  const bool scaled = fabs(gain_u - 1) > NOTABLE && fabs(gain_v / gain_u - 1) < NOTABLE;
  sentence[0] = '\0';
  if (scaled) {
    add(", both amplitudes are at ");
    add_percent(gain_u);
  }
  if (!scaled && fabs(gain_u - 1) > NOTABLE) {
    add(", the gain of U is at ");
    add_percent(gain_u);
  }
  if (!scaled && fabs(gain_v - 1) > NOTABLE) {
    add(", the gain of V is at ");
    add_percent(gain_v);
  }
  if (fabs(offset_u) > NOTABLE) add(", the offset of U has moved");
  if (fabs(offset_v) > NOTABLE) add(", the offset of V has moved");
  if (fabs(phase) > NOTABLE) add(", the phase shift is another");
  if (sentence[0] == '\0') return NULL;
  static const char begin[] = "the sensor has changed since calibration: ";
  memmove(sentence + sizeof begin - 1, sentence + 2, sizeof sentence - sizeof begin - 1);
  memcpy(sentence, begin, sizeof begin - 1);
  sentence[sizeof sentence - 1] = '\0';
  return sentence;
}
