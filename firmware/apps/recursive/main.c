// Self-calibration by software: recursive least squares or a Kalman filter finds the coefficients
// at a known speed and writes them into the coprocessor, whose own steps are 0, sample by sample.
// The coprocessor calibrates, judges, and gives the reference; then it calibrates alone with the
// parameters that were found.
//
// Status: 0 pass, 1 a verdict of fail, 2 the ADC refuses the settings,
// 3 no coprocessor on this board.
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "adc.h"
#include "an385.h"
#include "angle_report.h"
#include "capsoc_device.h"
#include "clock.h"
#include "common_settings.h"
#include "console.h"
#include "coprocessor.h"
#include "estimator.h"
#include "fixed_print.h"
#include "parameter_report.h"
#include "program_settings.h"
#include "sampling.h"
#include "supervision.h"

#define SETTINGS(NUMBER, TEXT)                                       \
  BAUD_SETTING(NUMBER)                                               \
  RATE_SETTING(NUMBER)                                               \
  SPEED_SETTING(NUMBER)                                              \
  NUMBER(uint32_t, forgetting, 0.0001, 0, 0.5, 0x1p31, "",           \
         "least squares: share of its knowledge that a sample ends") \
  NUMBER(uint64_t, drift, 0, 0, 1000, 0x1p48, "",                    \
         "Kalman: variance of a coefficient's step, noise = 1")      \
  DEMODULATION_SETTING(NUMBER)                                       \
  CALIBRATION_SETTING(NUMBER)                                        \
  PROGRESS_SETTING(NUMBER)                                           \
  MIRROR_SETTING(NUMBER)                                             \
  LIMIT_SETTING(NUMBER)                                              \
  ANGLE_STRIDE_SETTING(NUMBER)
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3 };

struct cost {
  uint64_t cycles;
  uint32_t most, updates, missed;
};

// The six weights between the estimator and the coprocessor, Q2.46 there.
static void write_weights(const struct estimator* state) {
  for (int i = 0; i < 2 * estimator_terms; ++i) {
    const double weight = state->weights[i / estimator_terms][i % estimator_terms];
    coprocessor_set_coefficient((enum coprocessor_coefficient)i, (int64_t)rint(weight * 0x1p46));
  }
}

static void read_weights(struct estimator* state) {
  for (int i = 0; i < 2 * estimator_terms; ++i)
    state->weights[i / estimator_terms][i % estimator_terms] =
        (double)coprocessor_coefficient((enum coprocessor_coefficient)i) * 0x1p-46;
}

// The newest result's sample and reference. The pipeline rests until the next sample.
static void learn_one(struct estimator* state, struct cost* cost) {
  const uint32_t begin = DWT->CYCCNT;
  const double phase = (double)COPROCESSOR->REF_PHASE * (0x1p-32 * 6.283185307179586);
  estimator_update(state, sin(phase), cos(phase), (double)COPROCESSOR->RAW_U * 0x1p-31,
                   (double)COPROCESSOR->RAW_V * 0x1p-31);
  write_weights(state);
  const uint32_t cycles = DWT->CYCCNT - begin;
  cost->cycles += cycles;
  if (cycles > cost->most) cost->most = cycles;
  ++cost->updates;
}

// False if the signal ended before. What comes while a sample is worked on is missed, and counted.
static bool learn(struct supervision* supervised, struct estimator* state, struct cost* cost) {
  const uint32_t period = supervision_period(supervised), last = settings.demodulation_samples;
  uint32_t next_look = period, next_line = settings.progress_seconds;
  for (uint32_t sample = 0; sample < last;) {
    if (!sampling_wait(sample + 1)) return false;
    const uint32_t newest = sampling_count();
    cost->missed += newest - sample - 1;
    sample = newest;
    learn_one(state, cost);
    judgement_look(&supervised->judgement);  // a turn's drift is from its end to the next one's
    if (sample < next_look && sample < last) continue;
    next_look += period;
    if (supervise(supervised, sample)) {
      read_weights(state);
      estimator_begin(state);
    }
    if (sample / settings.rate_hz < next_line) continue;
    next_line += settings.progress_seconds;
    const struct coprocessor_parameters parameters = coprocessor_read_parameters();
    print_progress(sample / settings.rate_hz, &parameters);
  }
  return true;
}

static void print_cost(const struct cost* cost) {
  print_text("recursive: ");
  print_unsigned(cost->updates != 0 ? cost->cycles / cost->updates : 0, 0);
  print_text(" cycles a sample, ");
  print_unsigned(cost->most, 0);
  print_text(" at most, ");
  print_unsigned(cost->missed, 0);
  print_text(" samples missed\n");
}

int main(void) {
  const uint32_t clock_hz = clock_frequency_hz();
  console_open(clock_hz, settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("recursive: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_text("recursive: self-calibration by a recursive estimator\n");
  console_start_buffering();
  int64_t frequency = 0;
  if (!coprocessor_frequency_word(settings.frequency_hz, clock_hz / settings.rate_hz, clock_hz,
                                  &frequency)) {
    print_text("recursive: half a turn a sample or more: frequency_hz is too high for rate_hz\n");
    return status_refused;
  }
  coprocessor_reset();
  coprocessor_set_frequency(frequency);
  coprocessor_lock_by_turns();
  coprocessor_set_steps(0);
  CoreDebug->DEMCR |= CoreDebug_DEMCR_TRCENA_Msk;
  DWT->CTRL |= DWT_CTRL_CYCCNTENA_Msk;
  // The stages keep the weights; the parameters follow what is written.
  COPROCESSOR->CTRL = SAMPLING_CTRL | COPROCESSOR_CTRL_DEMOD_Msk;
  if (!sampling_start(settings.rate_hz)) {
    print_text("recursive: the ADC refuses the sampling rate\n");
    return status_refused;
  }
  struct supervision supervised = {
      .name = "recursive",
      .rate_hz = settings.rate_hz,
      .mirror_seconds = settings.mirror_seconds,
      .judgement = {.limit = settings.limit_deg, .fewest = 2, .numeric = true}};
  struct estimator state = {.forgetting = (double)settings.forgetting * 0x1p-31,
                            .drift = (double)settings.drift * 0x1p-48};
  read_weights(&state);
  estimator_begin(&state);
  struct cost cost = {0};
  const bool complete = learn(&supervised, &state, &cost);
  // One more sample, so that the parameters are those of the last coefficients.
  const bool more = complete && sampling_wait(sampling_count() + 1);
  const struct coprocessor_parameters stored = coprocessor_read_parameters();
  const uint32_t learnt = sampling_count();
  COPROCESSOR->CTRL = SAMPLING_CTRL;
  coprocessor_load_parameters(&stored);
  judgement_cover(&supervised.judgement);
  print_cost(&cost);
  print_parameter_table(&stored);
  if (!more) {
    print_end(learnt);
  } else if (!print_angles(&supervised.judgement, learnt, settings.calibration_samples,
                           settings.angle_stride) ||
             !judgement_wait(&supervised.judgement, 4)) {
    print_end(sampling_count());
  }
  sampling_stop();
  judgement_finish(&supervised.judgement);
  return verdict(&supervised);
}
