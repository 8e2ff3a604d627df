#include "safe_angle.h"

#include <stddef.h>

#include "capsoc_device.h"
#include "coprocessor_safety.h"

#define ERROR_FLAGS                                                                      \
  (COPROCESSOR_FLAGS_CLIP_Msk | COPROCESSOR_FLAGS_SAT_Msk | COPROCESSOR_FLAGS_ZERO_Msk | \
   COPROCESSOR_FLAGS_EARLY_Msk | COPROCESSOR_FLAGS_CONFIG_Msk | COPROCESSOR_FLAGS_UNSETTLED_Msk)

enum { copied = 10 };
enum copied_word {
  copy_a1,
  copy_a2,
  copy_b1,
  copy_b2,
  copy_beta,
  copy_phi,
  copy_step,
  copy_limit,
  copy_step_limit,
  copy_computes
};

static int32_t product(int32_t a, int32_t b, unsigned shift) {
  return (int32_t)(((int64_t)a * b) >> shift);
}

int32_t safe_angle_sine(uint32_t angle) {
  // To -90 .. 90 degrees.
  const uint32_t quarter = UINT32_C(1) << 30;
  if ((angle + quarter) >= 2 * quarter) angle = 2 * quarter - angle;
  const int32_t z = (int32_t)angle;  // Q1.30 of a quarter turn
  const int32_t square = product(z, z, 30);
  // The series of sin(pi z / 2) to the ninth power, Q2.29.
  int32_t sum = 86136;                          // (pi/2)^9 / 9!
  sum = -2513498 + product(sum, square, 30);    // -(pi/2)^7 / 7!
  sum = 42784653 + product(sum, square, 30);    // (pi/2)^5 / 5!
  sum = -346799334 + product(sum, square, 30);  // -(pi/2)^3 / 3!
  sum = 843314857 + product(sum, square, 30);   // pi / 2
  const int32_t sine = product(sum, z, 29);
  const int32_t one = 1 << 30;
  return sine > one ? one : sine < -one ? -one : sine;
}

void safe_angle_begin(struct safe_angle* state, const struct coprocessor_parameters* parameters,
                      uint32_t limit, uint32_t step_limit, bool computes) {
  const uint32_t words[copied] = {(uint32_t)parameters->a1,
                                  (uint32_t)parameters->a2,
                                  (uint32_t)parameters->b1,
                                  (uint32_t)parameters->b2,
                                  parameters->beta,
                                  parameters->phi,
                                  (uint32_t)(coprocessor_frequency() >> 16),
                                  limit,
                                  step_limit,
                                  computes};
  for (unsigned i = 0; i < copied; ++i) {
    state->copy[i] = words[i];
    state->complement[i] = ~words[i];
  }
  state->samples = COPROCESSOR->SAMPLES;
  state->angle = COPROCESSOR->ANGLE;
  COPROCESSOR->FLAGS = ERROR_FLAGS;
}

static bool copy_is_whole(const struct safe_angle* state) {
  for (unsigned i = 0; i < copied; ++i)
    if (state->copy[i] != ~state->complement[i]) return false;
  return true;
}

static uint32_t magnitude(int32_t value) {
  return value < 0 ? 0 - (uint32_t)value : (uint32_t)value;
}

// Halves, Q1.30, so that differences fit.
static int32_t half(uint32_t word) {
  return (int32_t)word >> 1;
}

// Compares (X, Y), the converter's sample without its offsets, with (P, Q), the ellipse's point at
// the angle: a1 sin(angle), a2 cos(angle + beta). An error d of the angle gives X Q - Y P = a1 a2
// cos(beta) sin(d), times the sample's distance from the centre in units of the ellipse's.
static enum safe_angle_state compare(const struct safe_angle* state, uint32_t angle) {
  const uint32_t quarter = UINT32_C(1) << 30;
  const int32_t a1 = half(state->copy[copy_a1]), a2 = half(state->copy[copy_a2]);
  const int32_t p = product(a1, safe_angle_sine(angle), 30);
  const int32_t q = product(a2, safe_angle_sine(angle + state->copy[copy_beta] + quarter), 30);
  const int32_t x = half((uint32_t)ADC->DATA_U) - half(state->copy[copy_b1]);
  const int32_t y = half((uint32_t)ADC->DATA_V) - half(state->copy[copy_b2]);
  if (magnitude(x - p) > magnitude(a1) / 2 || magnitude(y - q) > magnitude(a2) / 2)
    return safe_angle_radius;
  const int64_t cross = ((int64_t)x * q - (int64_t)y * p) >> 30;
  const int32_t area =
      product(product(a1, a2, 30), safe_angle_sine(state->copy[copy_beta] + quarter), 30);
  const int32_t largest = product(area, safe_angle_sine(state->copy[copy_limit]), 30);
  const int64_t size = cross < 0 ? -cross : cross;
  // Three units for the roundings here.
  return size > (int64_t)magnitude(largest) + 3 ? safe_angle_inverse : safe_angle_good;
}

enum safe_angle_state safe_angle_found_by_coprocessor(void) {
  const uint32_t found = coprocessor_safety_found();
  if ((found & COPROCESSOR_FLAGS_PARITY_Msk) != 0) return safe_angle_parity;
  if ((found & COPROCESSOR_FLAGS_MISFIT_Msk) != 0) return safe_angle_misfit;
  if ((found & COPROCESSOR_FLAGS_JUMP_Msk) != 0) return safe_angle_jump;
  return found != 0 ? safe_angle_missed : safe_angle_good;
}

enum safe_angle_state safe_angle_read(struct safe_angle* state, uint32_t* angle) {
  const enum safe_angle_state its_own = safe_angle_found_by_coprocessor();
  if (its_own != safe_angle_good) return its_own;
  if (!copy_is_whole(state)) return safe_angle_copy;
  const uint32_t samples = COPROCESSOR->SAMPLES;
  if (samples != state->samples + 1) return safe_angle_samples;
  const uint32_t wanted = COPROCESSOR_STATUS_VALID_Msk | COPROCESSOR_STATUS_LOCK_Msk;
  const uint32_t unwanted = COPROCESSOR_STATUS_ALARM_Msk | COPROCESSOR_STATUS_DIVERGED_Msk;
  if ((COPROCESSOR->STATUS & (wanted | unwanted)) != wanted) return safe_angle_status;
  if ((COPROCESSOR->FLAGS & ERROR_FLAGS) != 0) return safe_angle_flags;
  const uint32_t found = COPROCESSOR->ANGLE;
  if (state->copy[copy_computes] != 0) {
    const enum safe_angle_state compared = compare(state, found);
    if (compared != safe_angle_good) return compared;
    const uint32_t step = found - state->angle - state->copy[copy_step];
    if (magnitude((int32_t)step) > state->copy[copy_step_limit]) return safe_angle_step;
  }
  state->samples = samples;
  *angle = state->angle = found;
  return safe_angle_good;
}

const char* safe_angle_sentence(enum safe_angle_state state) {
  static const char* const sentences[] = {
      NULL,
      "a register of the coprocessor has lost a bit",
      "the coprocessor's error is beyond its limit",
      "the coprocessor's angle moved beyond its limit",
      "a result of the coprocessor was not taken",
      "the copy of the parameters has changed",
      "a sample is missing, or there is one too many",
      "no valid angle, no lock, or an alarm",
      "an error flag",
      "the sample is far from the calibrated ellipse",
      "the angle is not the one of its sample",
      "the angle's step is not the one of the speed",
  };
  return sentences[state];
}
