// Self-calibration at an unknown speed. Measures one turn, demodulates against the numeric
// reference at that speed and trims it by the drift of phi. Then it hands over to the tracking
// reference, and in the end shows the angle reference, which needs no constant speed at all.
//
// Status: 0 pass, 1 no turn or a verdict of fail, 2 the ADC refuses the
// settings, 3 no coprocessor on this board.
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
#include "supervision.h"
#include "turn_meter.h"

// Wider tracking loops (kp = 4) follow ripple better. But so fast a reference also follows the
// angle's error, and the last part of the coefficients settles more slowly. At a constant speed the
// last turn shows 4.6e-7 deg as set here, and 2.4e-6 with kp = 4, ki = 10, numeric_until = 200 and
// drift_divider = 32. No time is so long that its samples at the highest rate do not fit 32 bits.
#define SETTINGS(NUMBER, TEXT)                                                                \
  BAUD_SETTING(NUMBER)                                                                        \
  RATE_SETTING(NUMBER)                                                                        \
  NUMBER(uint32_t, measuring_seconds, 100, 1, 40000, 1, "s", "that the first turns may take") \
  NUMBER(uint32_t, numeric_until, 150, 1, 40000, 1, "s",                                      \
         "end of the numeric reference, from the start of the ADC")                           \
  NUMBER(uint32_t, tracking_until, 400, 1, 40000, 1, "s", "end of the tracking reference")    \
  NUMBER(uint32_t, angle_until, 420, 1, 40000, 1, "s", "end of the angle reference")          \
  NUMBER(uint32_t, drift_divider, 256, 1, 1000000, 1, "",                                     \
         "1 / the share of phi's drift that corrects the frequency, a second")                \
  NUMBER(uint32_t, kp, 10, 0, 31, 1, "", "tracking loop: phase += error >> kp")               \
  NUMBER(uint32_t, ki, 22, 0, 31, 1, "", "tracking loop: frequency += error >> ki")           \
  HARMONICS_SETTING(NUMBER)                                                                   \
  LIMIT_SETTING(NUMBER)                                                                       \
  PROGRESS_SETTING(NUMBER)                                                                    \
  MIRROR_SETTING(NUMBER)
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3 };

// One demodulation. Seconds count from the start of the ADC; the coprocessor sees the samples from
// `first_sample` on.
struct session {
  struct supervision supervision;
  uint32_t first_sample;
  uint32_t trim_from;  // second of the first correction
  uint32_t phi;
  bool has_phi;
};

// True with the length of a turn in 1/256 sample and the samples it took.
static bool measure_turn(uint64_t* turn, uint32_t* samples) {
  struct turn_meter meter = {0};
  *turn = 0;
  sampling_listen(true);
  while (*turn == 0 && meter.samples < settings.measuring_seconds * settings.rate_hz) {
    int32_t u = 0, v = 0;
    if (!sampling_next(&u, &v)) break;
    *turn = turn_meter_feed(&meter, u);
  }
  sampling_listen(false);
  *samples = meter.samples;
  return *turn != 0;
}

static void print_frequency(int64_t word) {
  print_text("frequency ");
  print_signed(word, 0);
  print_text(" ");
  print_fixed(word * settings.rate_hz, 48, 9, 0);
  print_text(" Hz\n");
}

static uint32_t control(uint32_t reference) {
  return COPROCESSOR_CTRL_DEMOD_Msk | COPROCESSOR_CTRL_CALIB_Msk | COPROCESSOR_CTRL_ADC_Msk |
         COPROCESSOR_CTRL_IE_RESULT_Msk | reference << COPROCESSOR_CTRL_REF_Pos;
}

// One and a half turns.
static uint32_t turn_limit(uint64_t turn) {
  return (uint32_t)((turn + (turn >> 1)) >> 8) + 1;
}

static void start_demodulation(uint64_t turn) {
  const int64_t frequency = (int64_t)((((uint64_t)1 << 56) + turn / 2) / turn);
  // omega / 2 = pi / turn in Q1.31, the fastest step that settles: pi 2^31 256 / turn.
  const uint64_t step = UINT64_C(1727108826179) / turn;
  const uint64_t largest_step = 1u << 27;
  coprocessor_set_frequency(frequency);
  coprocessor_set_steps((uint32_t)(step < largest_step ? step : largest_step));
  coprocessor_set_loop(settings.kp, settings.ki);
  coprocessor_lock_by_turns();
  // A shaft that rests has no turns: the watchdog ends the window then.
  COPROCESSOR->TURN_LIMIT = turn_limit(turn);
  COPROCESSOR->CTRL = control(COPROCESSOR_CTRL_REF_NUMERIC);
  print_text("turn ");
  print_fixed((int64_t)turn, 8, 3, 0);
  print_text(" samples\n");
  print_frequency(frequency);
}

// A reference that is slow by a little shows as a phi that grows.
static void trim_frequency(struct session* session, uint32_t second) {
  const uint32_t phi = COPROCESSOR->PHI;
  const int32_t drift = (int32_t)(phi - session->phi);
  const bool usable = session->has_phi && second >= session->trim_from;
  session->phi = phi;
  session->has_phi = true;
  if (!usable) return;
  const int64_t frequency = coprocessor_frequency();
  int64_t change = (int64_t)drift * 65536 / ((int64_t)settings.rate_hz * settings.drift_divider);
  // While the coefficients still move, so does phi: no more than a thousandth at a time.
  const int64_t limit = (frequency < 0 ? -frequency : frequency) >> 10;
  if (change > limit) change = limit;
  if (change < -limit) change = -limit;
  coprocessor_set_frequency(frequency + change);
}

// Runs from the session's present second to `until`. False if the signal ended before.
static bool run(struct session* session, uint32_t from, uint32_t until, bool trim) {
  for (uint32_t second = from; second <= until; ++second) {
    const uint32_t sample = second * settings.rate_hz;
    if (!judgement_until(&session->supervision.judgement, sample - session->first_sample))
      return false;
    if (supervise(&session->supervision, sample)) session->has_phi = false;
    if (trim) trim_frequency(session, second);
    if (second % settings.progress_seconds == 0) {
      const struct coprocessor_parameters parameters = coprocessor_read_parameters();
      print_progress(second, &parameters);
    }
  }
  return true;
}

static uint32_t later(uint32_t one, uint32_t other) {
  return one > other ? one : other;
}

static bool show_angle_reference(struct session* session, uint32_t from) {
  struct judgement* const judgement = &session->supervision.judgement;
  judgement_cover(judgement);
  COPROCESSOR->CTRL = control(COPROCESSOR_CTRL_REF_ANGLE);
  print_text("angle reference\n");
  for (uint32_t second = from; second <= settings.angle_until; ++second) {
    const uint32_t sample = second * settings.rate_hz;
    if (!judgement_until(judgement, sample - session->first_sample)) return false;
    supervise(&session->supervision, sample);
    print_angle(sample);
  }
  // At least one turn with this reference, or the watchdog's word.
  return judgement->whole != 0 || judgement_wait(judgement, COPROCESSOR->TURN_LIMIT);
}

// Through the three references. False if the signal ended before.
static bool calibrate(struct session* session) {
  const uint32_t begin = session->first_sample / settings.rate_hz + 1;
  if (!run(session, begin, settings.numeric_until, true)) return false;
  COPROCESSOR->CTRL = control(COPROCESSOR_CTRL_REF_TRACKING);
  judgement_disturbed(&session->supervision.judgement);
  session->supervision.judgement.watches = true;
  print_text("tracking reference\n");
  const uint32_t tracking_begin = later(begin, settings.numeric_until + 1);
  if (!run(session, tracking_begin, settings.tracking_until, false)) return false;
  const struct coprocessor_parameters parameters = coprocessor_read_parameters();
  const int64_t frequency = coprocessor_frequency();
  print_parameter_table(&parameters);
  print_frequency(frequency);
  return show_angle_reference(session, later(begin, settings.tracking_until + 1));
}

static void report_end(uint32_t samples) {
  const struct coprocessor_parameters parameters = coprocessor_read_parameters();
  print_end(samples);
  print_parameter_table(&parameters);
  print_frequency(coprocessor_frequency());
}

int main(void) {
  console_open(clock_frequency_hz(), settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("track: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_text("track: self-calibration at an unknown speed\n");
  console_start_buffering();
  coprocessor_reset();
  if (!sampling_start(settings.rate_hz)) {
    print_text("track: the ADC refuses the sampling rate\n");
    return status_refused;
  }
  struct session session = {.supervision = {.name = "track",
                                            .rate_hz = settings.rate_hz,
                                            .mirror_seconds = settings.mirror_seconds,
                                            .judgement = {.limit = settings.limit_deg,
                                                          .unseen = settings.harmonics_deg,
                                                          .fewest = 2,
                                                          .discard = 1}}};
  uint64_t turn = 0;
  if (!measure_turn(&turn, &session.first_sample)) {
    return fail_because("track", "no turn seen");
  }
  start_demodulation(turn);
  // Phi means something after a turn.
  session.trim_from = (session.first_sample + (uint32_t)(turn >> 8)) / settings.rate_hz + 1;
  if (!calibrate(&session)) report_end(session.first_sample + sampling_count());
  sampling_stop();
  judgement_finish(&session.supervision.judgement);
  return verdict(&session.supervision);
}
