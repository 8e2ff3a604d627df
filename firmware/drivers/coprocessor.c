#include "coprocessor.h"

#include "an385.h"
#include "bus_probe.h"

enum { coefficient_fraction_bits = 15 };

bool coprocessor_present(void) {
  uint32_t id = 0;
  return bus_probe(COPROCESSOR_BASE, &id) && id == COPROCESSOR_ID_Reset;
}

void coprocessor_reset(void) {
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_SRST_Msk;
}

// All pairs: a read of the upper word latches the lower one, a write of the upper word takes over
// the lower one with it.
int64_t coprocessor_frequency(void) {
  const int32_t upper = COPROCESSOR->FREQ_HI;
  return (int64_t)upper * 65536 + (COPROCESSOR->FREQ_LO & 0xFFFFu);
}

void coprocessor_set_frequency(int64_t word) {
  COPROCESSOR->FREQ_LO = (uint32_t)word & 0xFFFFu;
  COPROCESSOR->FREQ_HI = (int32_t)(word >> 16);
}

bool coprocessor_frequency_word(int64_t speed, uint32_t period, uint32_t clock_hz, int64_t* word) {
  const uint64_t magnitude = speed < 0 ? 0 - (uint64_t)speed : (uint64_t)speed;
  const uint64_t half_turn = (uint64_t)1 << 47;
  // In two parts, since magnitude * period does not fit 64 bits.
  const uint64_t whole = magnitude / clock_hz, rest = magnitude % clock_hz;
  if (whole > half_turn / period) return false;
  const uint64_t turns = whole * period + (rest * period + clock_hz / 2) / clock_hz;
  if (turns >= half_turn) return false;
  *word = speed < 0 ? -(int64_t)turns : (int64_t)turns;
  return true;
}

uint64_t coprocessor_phase(void) {
  const uint32_t upper = COPROCESSOR->PHASE_HI;
  return (uint64_t)upper << 16 | (COPROCESSOR->PHASE_LO & 0xFFFFu);
}

void coprocessor_set_phase(uint64_t word) {
  COPROCESSOR->PHASE_LO = (uint32_t)word & 0xFFFFu;
  COPROCESSOR->PHASE_HI = (uint32_t)(word >> 16);
}

// The pairs follow one another in the order of the enumeration.
static volatile int32_t* coefficient_pair(enum coprocessor_coefficient which) {
  return &COPROCESSOR->AU_LO + 2 * which;
}

int64_t coprocessor_coefficient(enum coprocessor_coefficient which) {
  volatile int32_t* const pair = coefficient_pair(which);
  const int32_t upper = pair[1];
  return (int64_t)upper * (1 << coefficient_fraction_bits) + pair[0];
}

void coprocessor_set_coefficient(enum coprocessor_coefficient which, int64_t value) {
  volatile int32_t* const pair = coefficient_pair(which);
  const int64_t unit = 1 << coefficient_fraction_bits;
  int64_t upper = (value + unit / 2) >> coefficient_fraction_bits;
  if (upper > INT32_MAX) upper = INT32_MAX;
  if (upper < INT32_MIN) upper = INT32_MIN;
  int64_t lower = value - upper * unit;
  if (lower > INT32_MAX) lower = INT32_MAX;
  if (lower < INT32_MIN) lower = INT32_MIN;
  pair[0] = (int32_t)lower;
  pair[1] = (int32_t)upper;
}

bool coprocessor_set_steps(uint32_t step) {
  volatile uint32_t* const steps = &COPROCESSOR->STEP_AU;
  COPROCESSOR->FLAGS = COPROCESSOR_FLAGS_CONFIG_Msk;
  for (unsigned i = 0; i < 6; ++i) steps[i] = step;
  return (COPROCESSOR->FLAGS & COPROCESSOR_FLAGS_CONFIG_Msk) == 0;
}

uint32_t coprocessor_fastest_step(int64_t frequency_word) {
  const uint64_t magnitude = (uint64_t)(frequency_word < 0 ? -frequency_word : frequency_word);
  const uint64_t pi = 843314857;  // Q3.28
  const uint64_t step = ((magnitude >> 16) * pi) >> 29;
  const uint32_t largest = 1u << 27;
  return step < largest ? (uint32_t)step : largest;
}

void coprocessor_set_loop(uint32_t kp, uint32_t ki) {
  COPROCESSOR->LOOP = ((kp << COPROCESSOR_LOOP_KP_Pos) & COPROCESSOR_LOOP_KP_Msk) |
                      ((ki << COPROCESSOR_LOOP_KI_Pos) & COPROCESSOR_LOOP_KI_Msk);
}

struct coprocessor_parameters coprocessor_read_parameters(void) {
  const struct coprocessor_parameters parameters = {
      .a1 = COPROCESSOR->A1,
      .a2 = COPROCESSOR->A2,
      .b1 = COPROCESSOR->B1,
      .b2 = COPROCESSOR->B2,
      .beta = COPROCESSOR->BETA,
      .phi = COPROCESSOR->PHI,
  };
  return parameters;
}

void coprocessor_load_parameters(const struct coprocessor_parameters* parameters) {
  COPROCESSOR->A1 = parameters->a1;
  COPROCESSOR->A2 = parameters->a2;
  COPROCESSOR->B1 = parameters->b1;
  COPROCESSOR->B2 = parameters->b2;
  COPROCESSOR->BETA = parameters->beta;
  COPROCESSOR->PHI = parameters->phi;
  COPROCESSOR->CMD = COPROCESSOR_CMD_LOAD_Msk;
}

void coprocessor_reverse_reference(void) {
  coprocessor_set_frequency(-coprocessor_frequency());
  coprocessor_set_phase(0 - coprocessor_phase());
  coprocessor_set_coefficient(coefficient_a_u, -coprocessor_coefficient(coefficient_a_u));
  coprocessor_set_coefficient(coefficient_a_v, -coprocessor_coefficient(coefficient_a_v));
}

void coprocessor_lock_by_turns(void) {
  COPROCESSOR->LOCK_THRESHOLD = UINT32_MAX;
  const uint32_t limit = (COPROCESSOR->JUDGE & COPROCESSOR_JUDGE_RADIUS_LIMIT_Msk) >>
                         COPROCESSOR_JUDGE_RADIUS_LIMIT_Pos;
  COPROCESSOR->JUDGE |= limit << COPROCESSOR_JUDGE_ALARM_LIMIT_Pos;
}

void coprocessor_submit(int32_t u, int32_t v) {
  COPROCESSOR->SOFT_U = u;
  COPROCESSOR->SOFT_V = v;
}
