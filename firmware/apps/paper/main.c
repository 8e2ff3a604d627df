// The SoC paper's own program, as far as the paper describes it: section 4.2 and its Table 8. The
// step vectors W1 and W2, a clock of 25 MHz, 250 samples/s, a reference of 0.05 Hz, 400 s of
// demodulation, then one revolution with the stored parameters.
//
// The paper does not state three things that give its words. The steps are 2^-step_shift times as
// large (as printed they do not converge at this speed). The frequency word is cut to
// frequency_bits, and the reference leads its data by lead_samples. Its arctangent has operands of
// 16 bits, as they are: that is the hardware's (docs/explanation/papers.md has the command).
//
// Status: 0 pass, 1 a verdict of fail, 2 the ADC or the coprocessor refuses the settings,
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

// frequency_hz is kept in 2^-48 Hz, steps as Q1.31.
#define STEP(NUMBER, name, initial, help) \
  NUMBER(uint32_t, name, initial, 0, 0.9999999, 0x1p31, "", help)
#define SETTINGS(NUMBER, TEXT)                                                                  \
  BAUD_SETTING(NUMBER)                                                                          \
  RATE_SETTING(NUMBER)                                                                          \
  SPEED_SETTING(NUMBER)                                                                         \
  STEP(NUMBER, step_u_sine, 0.2, "W1, its first element")                                       \
  STEP(NUMBER, step_u_cosine, 0.2, "W1, its second")                                            \
  STEP(NUMBER, step_u_constant, 0.2, "W1, its third")                                           \
  STEP(NUMBER, step_v_sine, 0.5, "W2, its first element")                                       \
  STEP(NUMBER, step_v_cosine, 0.3, "W2, its second")                                            \
  STEP(NUMBER, step_v_constant, 0.1, "W2, its third")                                           \
  NUMBER(uint32_t, step_shift, 7, 0, 31, 1, "", "the steps are written 2^-step_shift so large") \
  NUMBER(uint32_t, frequency_bits, 31, 16, 48, 1, "", "of the frequency word; the rest is cut") \
  NUMBER(uint32_t, lead_samples, 2, 0, 1024, 1, "samples",                                      \
         "by which the reference is ahead of its data")                                         \
  DEMODULATION_SETTING(NUMBER)                                                                  \
  CALIBRATION_SETTING(NUMBER)                                                                   \
  PROGRESS_SETTING(NUMBER)                                                                      \
  MIRROR_SETTING(NUMBER)                                                                        \
  LIMIT_SETTING(NUMBER)                                                                         \
  ANGLE_STRIDE_SETTING(NUMBER)
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3 };
// A turn that is no whole number of samples ends one or two after those that were asked for.
enum { rest_of_turn = 2 };

// Table 11's two times: of the clock, and from a sample to what was made of it.
static void print_banner(uint32_t clock_hz) {
  print_text("paper: the SoC paper's steps W1 and W2\n");
  print_text("clock ");
  print_unsigned(clock_hz, 0);
  print_text(" Hz, ");
  print_unsigned(settings.rate_hz, 0);
  print_text(" samples/s, a result ");
  print_unsigned(COPROCESSOR->LATENCY, 0);
  print_text(" clocks after its sample\n");
}

static void write_steps(void) {
  const uint32_t shift = settings.step_shift;
  COPROCESSOR->STEP_AU = settings.step_u_sine >> shift;
  COPROCESSOR->STEP_BU = settings.step_u_cosine >> shift;
  COPROCESSOR->STEP_CU = settings.step_u_constant >> shift;
  COPROCESSOR->STEP_AV = settings.step_v_sine >> shift;
  COPROCESSOR->STEP_BV = settings.step_v_cosine >> shift;
  COPROCESSOR->STEP_CV = settings.step_v_constant >> shift;
}

// False if the shaft turns too fast for the rate.
static bool set_up_coprocessor(uint32_t clock_hz) {
  int64_t frequency = 0;
  const uint32_t period = clock_hz / settings.rate_hz;
  if (!coprocessor_frequency_word(settings.frequency_hz, period, clock_hz, &frequency))
    return false;
  const int64_t kept = (int64_t)1 << (48 - settings.frequency_bits);
  frequency = frequency / kept * kept;
  coprocessor_reset();
  coprocessor_set_frequency(frequency);
  coprocessor_set_phase(((uint64_t)frequency * settings.lead_samples) & 0xFFFFFFFFFFFFu);
  coprocessor_lock_by_turns();
  write_steps();
  return true;
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
    print_text("paper: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_banner(clock_hz);
  console_start_buffering();
  if (!set_up_coprocessor(clock_hz)) {
    print_text("paper: half a turn a sample or more: frequency_hz is too high for rate_hz\n");
    return status_refused;
  }
  COPROCESSOR->CTRL = SAMPLING_CTRL | COPROCESSOR_CTRL_DEMOD_Msk;
  if (!sampling_start(settings.rate_hz)) {
    print_text("paper: the ADC refuses the sampling rate\n");
    return status_refused;
  }

  struct supervision state = {
      .name = "paper",
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
             !judgement_wait(&state.judgement, rest_of_turn)) {
    print_end(sampling_count());
  }
  sampling_stop();
  judgement_finish(&state.judgement);
  return verdict(&state);
}
