#include "coprocessor_safety.h"

#include <stddef.h>

#include "capsoc_device.h"
#include "coprocessor.h"

#define FOUND                                                                                 \
  (COPROCESSOR_FLAGS_PARITY_Msk | COPROCESSOR_FLAGS_MISFIT_Msk | COPROCESSOR_FLAGS_JUMP_Msk | \
   COPROCESSOR_FLAGS_MISSED_Msk)

enum { largest_step_limit = 29, largest_error_limit = 31 };

uint32_t coprocessor_safety_found(void) {
  return COPROCESSOR->FLAGS & FOUND;
}

static uint32_t limits(uint32_t error, uint32_t step) {
  return error << COPROCESSOR_SAFETY_ERROR_LIMIT_Pos | step << COPROCESSOR_SAFETY_STEP_LIMIT_Pos;
}

// What is found in a sample. Its result is not taken.
static uint32_t submit(int32_t u, int32_t v) {
  coprocessor_submit(u, v);
  while ((COPROCESSOR->STATUS & COPROCESSOR_STATUS_BUSY_Msk) != 0) {
  }
  return coprocessor_safety_found();
}

// The same, and takes the result.
static uint32_t sample(int32_t u, int32_t v) {
  const uint32_t found = submit(u, v);
  COPROCESSOR->FLAGS = COPROCESSOR_FLAGS_RESULT_Msk | FOUND;
  return found;
}

// All registers with a parity bit but SAFETY, of a pair the upper one.
#define AT(name) offsetof(CAPSOC_COPROCESSOR_Type, name)
static const uint16_t registers[] = {
    AT(CTRL),    AT(STEP_AU),  AT(STEP_BU),        AT(STEP_CU), AT(STEP_AV), AT(STEP_BV),
    AT(STEP_CV), AT(LOOP),     AT(LOCK_THRESHOLD), AT(A1),      AT(A2),      AT(DIVERGE_THRESHOLD),
    AT(B1),      AT(B2),       AT(BETA),           AT(PHI),     AT(JUDGE),   AT(TURN_LIMIT),
    AT(FREQ_HI), AT(PHASE_HI), AT(AU_HI),          AT(BU_HI),   AT(CU_HI),   AT(AV_HI),
    AT(BV_HI),   AT(CV_HI)};
#undef AT

static volatile uint32_t* register_at(uint16_t offset) {
  return (volatile uint32_t*)((uintptr_t)COPROCESSOR + offset);
}

static bool test_parity(uint32_t on) {
  const uint32_t good = COPROCESSOR_FLAGS_PARITY_Msk;
  for (size_t i = 0; i < sizeof registers / sizeof registers[0]; ++i) {
    // After a reset the lower words are 0, and a write of the upper one makes it so.
    volatile uint32_t* const tested = register_at(registers[i]);
    const uint32_t word = *tested;
    COPROCESSOR->SAFETY = on | COPROCESSOR_SAFETY_BAD_PARITY_Msk;
    *tested = word;
    COPROCESSOR->SAFETY = on;  // with the wrong bit
    COPROCESSOR->SAFETY = on;
    if (sample(0, 0) != good) return false;
    *tested = word;
    if (sample(0, 0) != 0) return false;
  }
  COPROCESSOR->SAFETY = on | COPROCESSOR_SAFETY_BAD_PARITY_Msk;
  COPROCESSOR->SAFETY = on;
  if (sample(0, 0) != good) return false;
  COPROCESSOR->SAFETY = on;
  if (sample(0, 0) != 0) return false;
  // Coefficients on their way through the pipeline, of a sample that learns.
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_DEMOD_Msk;
  COPROCESSOR->SAFETY = on | COPROCESSOR_SAFETY_BAD_PARITY_Msk;
  if (sample(0, 0) != good) return false;
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_SRST_Msk;  // it has learnt
  COPROCESSOR->SAFETY = on;
  return sample(0, 0) == 0;
}

// Without coefficients the error of a sample is the sample.
static bool test_error_limits(void) {
  const uint32_t good = COPROCESSOR_FLAGS_MISFIT_Msk;
  coprocessor_set_coefficient(coefficient_a_u, 0);
  coprocessor_set_coefficient(coefficient_b_v, 0);
  for (uint32_t n = 1; n <= largest_error_limit; ++n) {
    const int32_t limit = (int32_t)(UINT32_C(1) << (31 - n));
    COPROCESSOR->SAFETY = COPROCESSOR_SAFETY_MISFIT_Msk | limits(n, 0);
    if (sample(limit - 1, -limit) != 0) return false;
    if (sample(limit, 0) != good || sample(0, -limit - 1) != good) return false;
  }
  return true;
}

// Angles of the reset's coefficients: the sine of channel U, the cosine of V.
static bool test_step_limits(void) {
  const int32_t radius = INT32_C(1) << 29, small = radius / 128;  // 1/804 turn
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_SRST_Msk;
  COPROCESSOR->SAFETY = COPROCESSOR_SAFETY_JUMP_Msk | limits(0, 1);
  if (sample(0, radius) != 0 || sample(0, -radius) != COPROCESSOR_FLAGS_JUMP_Msk) return false;
  if (sample(0, -radius) != 0) return false;
  COPROCESSOR->SAFETY = COPROCESSOR_SAFETY_JUMP_Msk | limits(0, 8);  // 1/512 turn
  if (sample(small, -radius) != 0 || sample(0, -radius) != 0) return false;
  COPROCESSOR->SAFETY = COPROCESSOR_SAFETY_JUMP_Msk | limits(0, 9);
  if (sample(small, -radius) != COPROCESSOR_FLAGS_JUMP_Msk) return false;
  COPROCESSOR->SAFETY = COPROCESSOR_SAFETY_JUMP_Msk | limits(0, largest_step_limit);
  return sample(0, -radius) == COPROCESSOR_FLAGS_JUMP_Msk && sample(0, -radius) == 0;
}

static bool test_missed(void) {
  COPROCESSOR->SAFETY = COPROCESSOR_SAFETY_MISSED_Msk;
  if (sample(0, 0) != 0 || submit(0, 0) != 0) return false;
  return sample(0, 0) == COPROCESSOR_FLAGS_MISSED_Msk;
}

const char* coprocessor_safety_test(void) {
  const char* failed = NULL;
  coprocessor_reset();
  COPROCESSOR->SAFETY = COPROCESSOR_SAFETY_ALL;
  if (COPROCESSOR->SAFETY != COPROCESSOR_SAFETY_ALL || sample(0, 0) != 0)
    failed = "the coprocessor has no safety mechanisms, or finds a fault in a good sample";
  else if (!test_parity(COPROCESSOR_SAFETY_ALL))
    failed = "the test of the parity bits";
  else if (!test_error_limits())
    failed = "the test of the limit of the error";
  else if (!test_step_limits())
    failed = "the test of the limit of the step";
  else if (!test_missed())
    failed = "the test of results that software does not take";
  coprocessor_reset();
  return failed;
}

// The most that `word` can be shifted to the left and stay below 2^31.
static uint32_t room(uint32_t word) {
  uint32_t places = 0;
  while (places < 31 && word >> (30 - places) == 0) ++places;
  return places;
}

void coprocessor_safety_begin(uint32_t mechanisms, uint32_t error, uint32_t step) {
  const uint32_t shift = room(step);
  COPROCESSOR->SAFETY =
      mechanisms | limits(room(error), shift < largest_step_limit ? shift : largest_step_limit);
  COPROCESSOR->FLAGS = FOUND;
}
