// Self-calibration as in selfcal, whose angles are checked in their own sample (safe_angle.h), with
// a watchdog from the start to the exit and memory protection (protection.h). What is found ends
// the program at once, with a pin that says so.
//
// Status:
// - 0 pass
// - 1 a verdict of fail, or an angle that was refused
// - 2 the ADC refuses the settings
// - 3 no coprocessor on this board
// - 4 stopped by the watchdog
// - 5 stopped by a fault or the memory protection
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
#include "coprocessor_safety.h"
#include "fixed_print.h"
#include "gpio.h"
#include "parameter_report.h"
#include "program_settings.h"
#include "program_verdict.h"
#include "protection.h"
#include "safe_angle.h"
#include "sampling.h"
#include "supervision.h"

// frequency_hz is kept in 2^-48 Hz, step as Q1.31.
#define SETTINGS(NUMBER, TEXT)                                                \
  BAUD_SETTING(NUMBER)                                                        \
  RATE_SETTING(NUMBER)                                                        \
  SPEED_SETTING(NUMBER)                                                       \
  NUMBER(uint32_t, step, 0.00062832, 0, 0.9999999, 0x1p31, "",                \
         "2 mu; omega / 2 is the fastest that settles, and 0 stands for it")  \
  DEMODULATION_SETTING(NUMBER)                                                \
  CALIBRATION_SETTING(NUMBER)                                                 \
  PROGRESS_SETTING(NUMBER)                                                    \
  MIRROR_SETTING(NUMBER)                                                      \
  LIMIT_SETTING(NUMBER)                                                       \
  ANGLE_STRIDE_SETTING(NUMBER)                                                \
  NUMBER(uint32_t, check_deg, 0.05, 0.001, 20, WORDS_PER_DEGREE, "deg",       \
         "by which an angle may differ from its sample's")                    \
  NUMBER(uint32_t, step_deg, 1, 0.001, 20, WORDS_PER_DEGREE, "deg",           \
         "by which a step may differ from the speed's, apart from noise")     \
  NUMBER(uint32_t, coprocessor_checks, 1, 0, 1, 1, "",                        \
         "1: the coprocessor's safety mechanisms are tested and switched on") \
  NUMBER(uint32_t, mechanisms, 15, 0, 15, 1, "",                              \
         "which of them: the sum of 1 PARITY, 2 MISFIT, 4 JUMP, 8 MISSED")    \
  NUMBER(uint32_t, program_checks, 1, 0, 1, 1, "",                            \
         "1: the program computes what each angle's sample should be")
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3 };
// Of the watchdog outside calibration mode: longer than from one look at what is learnt to the
// next, and than all that is printed at once.
enum { watchdog_seconds = 10 };

// What the checks compare with: written once, then protected.
static struct {
  struct coprocessor_parameters stored;
  // Of the calibration, and the same, every bit inverted: read for each sample, never kept.
  volatile uint32_t last_sample, last_complement;
} parameters __attribute__((aligned(32)));
_Static_assert(sizeof parameters == 32, "a region of the memory protection");

static struct safe_angle safe;

static void print_banner(uint32_t clock_hz) {
  print_text("safe: self-calibration with checked angles\n");
  print_text("clock ");
  print_unsigned(clock_hz, 0);
  print_text(" Hz, ");
  print_unsigned(settings.rate_hz, 0);
  print_text(" samples/s\n");
}

// False if the shaft turns too fast for the rate.
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

static int refuse_angle(enum safe_angle_state why, uint32_t sample) {
  gpio_write(GPIO0, angle_good_pin, 0);
  watchdog_start(watchdog_seconds * clock_frequency_hz());
  sampling_stop();
  print_text("safe: no angle for sample ");
  print_unsigned(sample, 0);
  print_text("\n");
  return fail_because("safe", safe_angle_sentence(why));
}

// Of the angle from one sample to the next, at most: the residue of the last turn is the noise of
// one angle, and later turns may have a little more. 2^-32 turn, below 1/16 turn.
static uint32_t step_noise(const struct judgement* judgement) {
  const uint32_t largest = UINT32_C(1) << 26;
  const uint32_t residue = judgement->before != 0 ? judgement->turns[0].residue : 0;
  return residue < largest ? 3 * residue : 3 * largest;
}

// The coprocessor's limits, from those of the program: an error of the angle moves a signal by no
// more than its amplitude times the error's sine; what the samples' errors are anyway comes on top.
static void limit_coprocessor(const struct coprocessor_parameters* p, uint32_t errors,
                              uint32_t noise) {
  const int32_t smaller = p->a1 < p->a2 ? p->a1 : p->a2;
  const int32_t sine = safe_angle_sine(settings.check_deg);
  const uint32_t error = (uint32_t)(((int64_t)smaller * sine) >> 30);
  const int32_t speed = (int32_t)(coprocessor_frequency() >> 16);
  const uint32_t step = speed < 0 ? 0 - (uint32_t)speed : (uint32_t)speed;
  coprocessor_safety_begin(settings.mechanisms, error + errors, step + settings.step_deg + noise);
}

static void begin_without_limits(void) {
  coprocessor_safety_begin(settings.mechanisms & COPROCESSOR_SAFETY_WITHOUT_LIMITS, 0, 0);
}

// Eight times the average error: a sine's largest value is 1.6 times its average, noise's rarely
// six times. From half of full scale on any error is good.
static uint32_t errors_while_learning(void) {
  const uint32_t average = COPROCESSOR->ERROR_AVERAGE, half = UINT32_C(1) << 30;
  return average < half / 8 ? 8 * average : 2 * half;
}

// While it learns. Without a lock any error and any step is good; with one the errors are also
// those of coefficients that are not there yet.
static bool watch_learning(const struct supervision* state) {
  watchdog_serve();
  if (settings.coprocessor_checks == 0) return true;
  if (coprocessor_safety_found() != 0) return false;
  if (state->locked_at == 0 || state->judgement.before == 0)
    begin_without_limits();
  else
    limit_coprocessor(&state->judgement.parameters, errors_while_learning(),
                      step_noise(&state->judgement));
  return true;
}

// Waits for the calibration's angle of `sample`. `*is_over`: there is none, because it was the last
// or the signal has ended. What says so is asked twice: what counts or waits may be what is broken.
static enum safe_angle_state next_angle(struct supervision* state, uint32_t sample, bool* is_over) {
  const uint32_t last = parameters.last_sample;
  if (last != ~parameters.last_complement) return safe_angle_copy;
  if (sample > last) {
    *is_over = true;
    return sampling_count() >= last ? safe_angle_good : safe_angle_samples;
  }
  if (judgement_until(&state->judgement, sample)) {
    uint32_t angle = 0;
    return safe_angle_read(&safe, &angle);
  }
  if (!adc_ended()) return safe_angle_samples;
  *is_over = true;
  print_end(sampling_count());
  return safe_angle_good;
}

// Every angle of the calibration. True, or the program's status in `*status`.
static bool calibrate(struct supervision* state, uint32_t first, int* status) {
  for (uint32_t sample = first + 1;; ++sample) {
    bool is_over = false;
    const enum safe_angle_state found = next_angle(state, sample, &is_over);
    if (found != safe_angle_good) {
      *status = refuse_angle(found, sample);
      return false;
    }
    if (is_over) return true;
    gpio_write(GPIO0, angle_good_pin, angle_good_pin);
    watchdog_serve();
    if ((sample - first) % settings.angle_stride == 0) print_angle(sample);
  }
}

int main(void) {
  const uint32_t clock_hz = clock_frequency_hz();
  console_open(clock_hz, settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("safe: no coprocessor here\n");
    return status_no_coprocessor;
  }
  gpio_make_output(GPIO0, angle_good_pin);
  print_banner(clock_hz);
  console_start_buffering();
  watchdog_start(watchdog_seconds * clock_hz);

  const char* const failed = settings.coprocessor_checks != 0 ? coprocessor_safety_test() : NULL;
  if (failed != NULL) return fail_because("safe", failed);
  if (!set_up_coprocessor(clock_hz)) {
    print_text("safe: half a turn a sample or more: frequency_hz is too high for rate_hz\n");
    return status_refused;
  }
  if (settings.coprocessor_checks != 0) begin_without_limits();
  COPROCESSOR->CTRL = SAMPLING_CTRL | COPROCESSOR_CTRL_DEMOD_Msk;
  if (!sampling_start(settings.rate_hz)) {
    print_text("safe: the ADC refuses the sampling rate\n");
    return status_refused;
  }

  struct supervision state = {
      .name = "safe",
      .rate_hz = settings.rate_hz,
      .mirror_seconds = settings.mirror_seconds,
      .goes_on = watch_learning,
      .judgement = {.limit = settings.limit_deg, .fewest = 2, .numeric = true}};
  if (!demodulate(&state, settings.demodulation_samples, settings.progress_seconds)) {
    const enum safe_angle_state found = safe_angle_found_by_coprocessor();
    if (settings.coprocessor_checks != 0 && found != safe_angle_good)
      return refuse_angle(found, sampling_count());
    print_end(sampling_count());
    sampling_stop();
    judgement_finish(&state.judgement);
    return verdict(&state);
  }
  // Before anything is printed: the next sample is already one of the calibration.
  parameters.stored = coprocessor_read_parameters();
  const uint32_t demodulated = sampling_count();
  parameters.last_sample = demodulated + settings.calibration_samples;
  parameters.last_complement = ~parameters.last_sample;
  COPROCESSOR->CTRL = SAMPLING_CTRL;
  coprocessor_load_parameters(&parameters.stored);
  judgement_cover(&state.judgement);
  safe_angle_begin(&safe, &parameters.stored, settings.check_deg,
                   settings.step_deg + step_noise(&state.judgement), settings.program_checks != 0);
  if (settings.coprocessor_checks != 0)
    limit_coprocessor(&parameters.stored, 4 * COPROCESSOR->ERROR_AVERAGE,
                      step_noise(&state.judgement));
  protect_memory(&parameters, sizeof parameters);
  // Two sample periods: one until the sample, one for what handles it.
  watchdog_start(2 * (clock_hz / settings.rate_hz));
  print_text("calibration with the stored parameters\n");
  print_parameter_table(&parameters.stored);

  int status = 0;
  if (!calibrate(&state, demodulated, &status)) return status;
  watchdog_start(watchdog_seconds * clock_hz);
  gpio_write(GPIO0, angle_good_pin, 0);
  sampling_stop();
  judgement_finish(&state.judgement);
  return verdict(&state);
}
