// Self-calibration by blocks: the coefficients change once a turn, by the normal equations of all
// its samples. At an unknown speed the first turn's range gives the coefficients to start with, and
// the angle of each sample is its own reference. At a known speed the first turn of the numeric
// reference is enough. After some turns it calibrates with the parameters that it found.
//
// Status: 0 pass, 1 no turn or a verdict of fail, 2 the ADC refuses the settings,
// 3 no coprocessor on this board, or one without block learning.
#include <stdbool.h>
#include <stdint.h>

#include "adc.h"
#include "angle_report.h"
#include "blocks.h"
#include "capsoc_device.h"
#include "clock.h"
#include "common_settings.h"
#include "console.h"
#include "coprocessor.h"
#include "fixed_print.h"
#include "parameter_report.h"
#include "program_settings.h"
#include "program_verdict.h"
#include "sampling.h"
#include "supervision.h"

#define SETTINGS(NUMBER, TEXT)                                                                \
  BAUD_SETTING(NUMBER)                                                                        \
  RATE_SETTING(NUMBER)                                                                        \
  NUMBER(int64_t, frequency_hz, 0, -10000, 10000, 0x1p48, "Hz",                               \
         "speed of the shaft; 0: unknown, and it may change")                                 \
  NUMBER(uint32_t, measuring_seconds, 100, 1, 40000, 1, "s", "that the first turns may take") \
  NUMBER(uint32_t, turns, 6, 4, 1e6, 1, "", "of learning")                                    \
  CALIBRATION_SETTING(NUMBER)                                                                 \
  MIRROR_SETTING(NUMBER)                                                                      \
  HARMONICS_SETTING(NUMBER)                                                                   \
  LIMIT_SETTING(NUMBER)                                                                       \
  ANGLE_STRIDE_SETTING(NUMBER)
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3 };

#define LEARNING (SAMPLING_CTRL | COPROCESSOR_CTRL_DEMOD_Msk | COPROCESSOR_CTRL_BLOCK_Msk)

// Samples of a turn; at least 22, for fewer are never judged good.
static uint32_t turn_of(int64_t frequency) {
  const uint64_t speed = (uint64_t)(frequency < 0 ? -frequency : frequency);
  const uint64_t samples = ((UINT64_C(1) << 48) + speed / 2) / speed;
  return samples < 22 ? 22 : samples > 1u << 30 ? 1u << 30 : (uint32_t)samples;
}

// One sample without BLOCK ends the block under way.
static bool drop_block(uint32_t control, uint32_t sample) {
  COPROCESSOR->CTRL = control & ~COPROCESSOR_CTRL_BLOCK_Msk;
  const bool more = sampling_wait(sample + 1);
  COPROCESSOR->CTRL = control;
  return more;
}

// From coefficients of 0 the error is the sample itself, which no word is too short for: one turn
// gives all of them exactly. From those of the reset the error of a large sensor would be cut off.
static void start_from_nothing(void) {
  for (int i = coefficient_a_u; i <= coefficient_c_v; ++i)
    coprocessor_set_coefficient((enum coprocessor_coefficient)i, 0);
}

// Turns that may be added if the last ones were no good.
enum { more_turns = 2 };

static bool learnt(const struct judgement* judgement, uint32_t shown) {
  if (shown < settings.turns) return false;
  return judgement->before >= judgement->fewest || shown >= settings.turns + more_turns;
}

// Learns window by window until settings.turns windows were kept. From the third turn on, the first
// good turn sets CTRL.GUARD, after which only good turns count. Not earlier: the angle of
// coefficients that were never learned need not go round, and the second turn still has one sample
// with those. False if the signal ended before.
static bool learn(struct supervision* state, uint32_t control, uint32_t turn) {
  struct judgement* const judgement = &state->judgement;
  uint32_t shown = 0;
  for (uint32_t sample = 1; !learnt(judgement, shown); ++sample) {
    if (!sampling_wait(sample)) return false;
    // The sample after a turn: its block has been taken over.
    if (shown >= 2 && (control & COPROCESSOR_CTRL_GUARD_Msk) == 0 &&
        (COPROCESSOR->TURN_FLAGS & COPROCESSOR_TURN_FLAGS_GOOD_Msk) != 0) {
      control |= COPROCESSOR_CTRL_GUARD_Msk;
      COPROCESSOR->CTRL = control;
    }
    judgement_look(judgement);
    const bool ended = judgement->judged != shown;
    // The sums of the block under way are of the other direction then.
    if ((ended || sample % settings.rate_hz == 0) && supervise(state, sample) &&
        !drop_block(control, sample))
      return false;
    if (!ended) continue;
    shown = judgement->judged;
    if (!judgement->numeric && (COPROCESSOR->TURN_FLAGS & COPROCESSOR_TURN_FLAGS_GOOD_Msk) != 0)
      turn = COPROCESSOR->TURN_SAMPLES;
    if (!judgement->numeric) blocks_set_steps(turn, shown % 2 == 0 ? 2 : 1);
    const struct coprocessor_parameters parameters = coprocessor_read_parameters();
    print_progress(sample / settings.rate_hz, &parameters);
  }
  return true;
}

int main(void) {
  const uint32_t clock_hz = clock_frequency_hz();
  console_open(clock_hz, settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("quick: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_text("quick: self-calibration by blocks of a turn\n");
  console_start_buffering();
  coprocessor_reset();
  if (!blocks_present()) {
    print_text("quick: this coprocessor has no block learning (the arithmetic paper has none)\n");
    return status_no_coprocessor;
  }
  const bool known = settings.frequency_hz != 0;
  uint32_t turn = 0;
  if (known) {
    int64_t frequency = 0;
    if (!coprocessor_frequency_word(settings.frequency_hz, clock_hz / settings.rate_hz, clock_hz,
                                    &frequency)) {
      print_text("quick: half a turn a sample or more: frequency_hz is too high for rate_hz\n");
      return status_refused;
    }
    coprocessor_set_frequency(frequency);
    start_from_nothing();
    turn = turn_of(frequency);
  }
  if (!sampling_start(settings.rate_hz)) {
    print_text("quick: the ADC refuses the sampling rate\n");
    return status_refused;
  }
  if (!known) turn = blocks_measure_turn(settings.measuring_seconds * settings.rate_hz);
  if (turn == 0) return fail_because("quick", "no turn seen");
  coprocessor_lock_by_turns();
  blocks_watch(turn);
  blocks_set_steps(turn, known ? 1 : 2);
  const uint32_t control =
      LEARNING | (known ? 0 : COPROCESSOR_CTRL_REF_ANGLE << COPROCESSOR_CTRL_REF_Pos);
  COPROCESSOR->CTRL = control;

  struct supervision state = {.name = "quick",
                              .rate_hz = settings.rate_hz,
                              .mirror_seconds = known ? settings.mirror_seconds : UINT32_MAX,
                              .judgement = {.limit = settings.limit_deg,
                                            .unseen = known ? 0 : settings.harmonics_deg,
                                            .fewest = 2,
                                            .numeric = known,
                                            .watches = !known}};
  const bool complete = learn(&state, control, turn);
  const struct coprocessor_parameters stored = coprocessor_read_parameters();
  const uint32_t learnt = sampling_count();
  COPROCESSOR->CTRL = control & ~(COPROCESSOR_CTRL_DEMOD_Msk | COPROCESSOR_CTRL_BLOCK_Msk);
  coprocessor_load_parameters(&stored);
  judgement_cover(&state.judgement);
  print_parameter_table(&stored);
  if (!complete) {
    print_end(learnt);
  } else if (!print_angles(&state.judgement, learnt, settings.calibration_samples,
                           settings.angle_stride)) {
    print_end(sampling_count());
  }
  sampling_stop();
  judgement_finish(&state.judgement);
  return verdict(&state);
}
