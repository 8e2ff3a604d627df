// Self-calibration on samples in any order, as the CSFN paper has them: the reference is the
// calibrated angle of the sample itself, so neither speed nor order matters. 400 s of demodulation,
// or as long as the signal lasts, then calibration with the stored parameters.
//
// Not for slow motion in order: the step is far above 1.5 omega of 0.05 Hz
// (docs/reference/coprocessor.md).
//
// Samples in any order make no turns: they are judged by the window, which must hold every part of
// the turn. Samples that come twice at once are seen; of other stale ones, and of harmonics along
// the circle, a pass says that it knows nothing.
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
#include "program_verdict.h"
#include "sampling.h"
#include "start_range.h"
#include "supervision.h"

// step is kept as Q1.31.
#define SETTINGS(NUMBER, TEXT)                                                              \
  BAUD_SETTING(NUMBER)                                                                      \
  RATE_SETTING(NUMBER)                                                                      \
  NUMBER(uint32_t, step, 0.01, 0, 0.9999999, 0x1p31, "", "2 mu")                            \
  DEMODULATION_SETTING(NUMBER)                                                              \
  CALIBRATION_SETTING(NUMBER)                                                               \
  NUMBER(uint32_t, range_samples, 500, 2, 1e6, 1, "samples",                                \
         "whose range gives the parameters to start with")                                  \
  NUMBER(uint32_t, window_samples, 4750, 64, 1e9, 1, "samples", "that are judged together") \
  HARMONICS_SETTING(NUMBER)                                                                 \
  LIMIT_SETTING(NUMBER)                                                                     \
  PROGRESS_SETTING(NUMBER)                                                                  \
  ANGLE_STRIDE_SETTING(NUMBER)
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3 };

// From the range of the first samples. False if the signal ended before.
static bool load_start(void) {
  struct start_range range = {0};
  sampling_listen(true);
  for (uint32_t i = 0; i < settings.range_samples; ++i) {
    int32_t u = 0, v = 0;
    if (!sampling_next(&u, &v)) return false;
    start_range_feed(&range, u, v);
  }
  sampling_listen(false);
  start_range_load(&range);
  return true;
}

int main(void) {
  console_open(clock_frequency_hz(), settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("unordered: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_text("unordered: self-calibration on samples in any order\n");
  console_start_buffering();

  coprocessor_reset();
  coprocessor_set_steps(settings.step);
  coprocessor_lock_by_turns();
  COPROCESSOR->TURN_LIMIT = settings.window_samples;
  COPROCESSOR->JUDGE |= COPROCESSOR_JUDGE_COUNT_Msk;
  const uint32_t gates = COPROCESSOR_CTRL_CALIB_Msk | COPROCESSOR_CTRL_ADC_Msk |
                         COPROCESSOR_CTRL_IE_RESULT_Msk |
                         COPROCESSOR_CTRL_REF_ANGLE << COPROCESSOR_CTRL_REF_Pos;
  sampling_count_oddities();
  if (!sampling_start(settings.rate_hz)) {
    print_text("unordered: the ADC refuses the sampling rate\n");
    return status_refused;
  }
  if (!load_start()) return fail_because("unordered", "the signal ended before its range was seen");
  COPROCESSOR->CTRL = gates | COPROCESSOR_CTRL_DEMOD_Msk;

  // The angle has no direction that could be turned round.
  struct supervision state = {.name = "unordered",
                              .rate_hz = settings.rate_hz,
                              .mirror_seconds = UINT32_MAX,
                              .judgement = {.limit = settings.limit_deg,
                                            .unseen = settings.harmonics_deg,
                                            .fewest = 1,
                                            .shuffled = true}};
  const bool complete =
      demodulate(&state, settings.demodulation_samples, settings.progress_seconds);
  // Before anything is printed: the next sample is already one of the calibration.
  const struct coprocessor_parameters stored = coprocessor_read_parameters();
  const uint32_t demodulated = sampling_count();
  COPROCESSOR->CTRL = gates;
  coprocessor_load_parameters(&stored);
  judgement_cover(&state.judgement);
  print_parameter_table(&stored);
  if (!complete) {
    print_end(demodulated);
  } else if (!print_angles(&state.judgement, demodulated, settings.calibration_samples,
                           settings.angle_stride)) {
    print_end(sampling_count());
  }
  sampling_stop();
  judgement_finish(&state.judgement);
  return verdict(&state);
}
