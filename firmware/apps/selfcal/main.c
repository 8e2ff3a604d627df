// Self-calibration at a known speed, as in the paper: demodulate for 400 s against the numeric
// reference, store the six parameters, then calibrate with the stored ones for one revolution.
//
// A pass needs two good turns, of calibration or the last of demodulation, and is about all of the
// calibration.
//
// Status: 0 pass, 1 a verdict of fail, 2 the ADC refuses the settings,
// 3 no coprocessor on this board.
#include <stdbool.h>
#include <stdint.h>

#include "adc.h"
#include "angle_report.h"
#include "capsoc_device.h"
#include "clock.h"
#include "common_settings.h"
#include "console.h"
#include "coprocessor.h"
#include "fixed_print.h"
#include "parameter_report.h"
#include "program_settings.h"
#include "sampling.h"
#include "supervision.h"

// frequency_hz is kept in 2^-48 Hz, step as Q1.31.
#define SETTINGS(NUMBER, TEXT)                                               \
  BAUD_SETTING(NUMBER)                                                       \
  RATE_SETTING(NUMBER)                                                       \
  SPEED_SETTING(NUMBER)                                                      \
  NUMBER(uint32_t, step, 0.00062832, 0, 0.9999999, 0x1p31, "",               \
         "2 mu; omega / 2 is the fastest that settles, and 0 stands for it") \
  DEMODULATION_SETTING(NUMBER)                                               \
  CALIBRATION_SETTING(NUMBER)                                                \
  PROGRESS_SETTING(NUMBER)                                                   \
  MIRROR_SETTING(NUMBER)                                                     \
  LIMIT_SETTING(NUMBER)                                                      \
  ANGLE_STRIDE_SETTING(NUMBER)
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3 };

static void print_banner(uint32_t clock_hz) {
  print_text("selfcal: self-calibration at a known speed\n");
  print_text("clock ");
  print_unsigned(clock_hz, 0);
  print_text(" Hz, ");
  print_unsigned(settings.rate_hz, 0);
  print_text(" samples/s, ");
  print_unsigned(ADC->BITS, 0);
  print_text(" bits, ");
  const uint32_t status = COPROCESSOR->STATUS;
  const bool paper = (status & COPROCESSOR_STATUS_ARITH_Msk) != 0;
  print_text(paper ? "paper arithmetic\n" : "precise arithmetic\n");
}

// Reference and steps as the settings want them. False if the shaft turns too fast for the rate.
static bool set_up_coprocessor(uint32_t clock_hz) {
  int64_t frequency = 0;
  const uint32_t period = clock_hz / settings.rate_hz;
  if (!coprocessor_frequency_word(settings.frequency_hz, period, clock_hz, &frequency))
    return false;
  coprocessor_reset();
  coprocessor_set_frequency(frequency);
  coprocessor_lock_by_turns();
  coprocessor_set_steps(settings.step != 0 ? settings.step : coprocessor_fastest_step(frequency));
  return true;
}

// Samples until the reference's turn ends if it does so at once: a turn that is no whole number of
// samples ends one sample after those that were asked for.
static uint32_t rest_of_turn(void) {
  const int64_t frequency = coprocessor_frequency();
  const uint64_t speed = (uint64_t)(frequency < 0 ? -frequency : frequency);
  const uint64_t phase = coprocessor_phase();
  const uint64_t way = frequency < 0 ? phase : (UINT64_C(1) << 48) - phase;
  return way <= 2 * speed ? 2 : 0;
}

static bool calibrate(struct judgement* judgement, const struct coprocessor_parameters* stored,
                      uint32_t first) {
  print_text("calibration with the stored parameters\n");
  print_parameter_table(stored);
  return print_angles(judgement, first, settings.calibration_samples, settings.angle_stride);
}

int main(void) {
  const uint32_t clock_hz = clock_frequency_hz();
  console_open(clock_hz, settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("selfcal: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_banner(clock_hz);
  console_start_buffering();

  if (!set_up_coprocessor(clock_hz)) {
    print_text("selfcal: half a turn a sample or more: frequency_hz is too high for rate_hz\n");
    return status_refused;
  }
  COPROCESSOR->CTRL = SAMPLING_CTRL | COPROCESSOR_CTRL_DEMOD_Msk;
  if (!sampling_start(settings.rate_hz)) {
    print_text("selfcal: the ADC refuses the sampling rate\n");
    return status_refused;
  }

  struct supervision state = {
      .name = "selfcal",
      .rate_hz = settings.rate_hz,
      .mirror_seconds = settings.mirror_seconds,
      .judgement = {.limit = settings.limit_deg, .fewest = 2, .numeric = true}};
  const bool complete =
      demodulate(&state, settings.demodulation_samples, settings.progress_seconds);
  // Before anything is printed: the next sample is already one of the calibration.
  const struct coprocessor_parameters stored = coprocessor_read_parameters();
  const uint32_t demodulated = sampling_count();
  COPROCESSOR->CTRL = SAMPLING_CTRL;
  coprocessor_load_parameters(&stored);
  judgement_cover(&state.judgement);
  if (!complete) {
    print_end(demodulated);
    print_parameter_table(&stored);
  } else if (!calibrate(&state.judgement, &stored, demodulated) ||
             !judgement_wait(&state.judgement, rest_of_turn())) {
    print_end(sampling_count());
  }
  sampling_stop();
  judgement_finish(&state.judgement);
  return verdict(&state);
}
