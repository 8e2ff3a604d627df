// Self-calibration that never ends, for a sensor that drifts on a shaft of any speed: it stops,
// turns back, and turns from very slowly to some hundredth of the sampling rate. The coefficients
// change once a turn by blocks, the steps go with the speed, and while the shaft rests nothing is
// learnt. The verdict is about every angle since the lock, not about the last turns alone.
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
#include "follower.h"
#include "judgement.h"
#include "parameter_report.h"
#include "program_settings.h"
#include "program_verdict.h"
#include "sampling.h"
#include "supervision.h"

// drift_per_s is kept as Q0.32. At the highest rate a sample leaves the processor 1,250 cycles.
#define SETTINGS(NUMBER, TEXT)                                                                 \
  BAUD_SETTING(NUMBER)                                                                         \
  NUMBER(uint32_t, rate_hz, 5000, 1, 20000, 1, "Hz", "samples a second, 22 a turn or more")    \
  NUMBER(uint32_t, seconds, 60, 1, 40000, 1, "s", "that are followed, from the first turn on") \
  NUMBER(uint32_t, measuring_seconds, 100, 1, 40000, 1, "s", "that the first turn may take")   \
  NUMBER(uint32_t, longest_turn_seconds, 20, 1, 100, 1, "s", "slower turns are not learnt")    \
  NUMBER(uint32_t, turns, 6, 2, 1000, 1, "", "good ones before an angle counts")               \
  NUMBER(uint32_t, drift_per_s, 0.001, 0, 0.5, 0x1p32, "1/s",                                  \
         "drift that is to be reckoned with, of an amplitude, or rad")                         \
  HARMONICS_SETTING(NUMBER)                                                                    \
  LIMIT_SETTING(NUMBER)                                                                        \
  NUMBER(uint32_t, progress_seconds, 5, 1, 1e9, 1, "s", "from one line of parameters to the next")
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3 };

// With all parameters drifting at the same rate an angle goes at most 3.1 times as fast where the
// phase error is small, and 5.8 times where it is 0.8 rad.
enum { worst_of_all = 6 };

// A start may have raised them; the lock clears them, and then they count.
#define ERRORS_SINCE_LOCK                                                                    \
  (COPROCESSOR_FLAGS_SAT_Msk | COPROCESSOR_FLAGS_DIVERGED_Msk | COPROCESSOR_FLAGS_CLIP_Msk | \
   COPROCESSOR_FLAGS_ALARM_Msk)

struct session {
  struct follower follower;
  struct judgement judgement;
  uint32_t turns;         // good ones so far
  uint32_t learnt;        // sample at the end of the last of them
  uint32_t bound;         // by what it shows, 2^-32 turn
  uint32_t worst;         // since the lock
  uint32_t locked_at;     // sample; 0: not yet
  uint32_t resting;       // samples since the lock
  uint32_t errors;        // COPROCESSOR_FLAGS_..._Msk since the lock that contradict the angles
  const char* objection;  // the first one since the lock; null: none
};

#define LEARNING                                                             \
  (SAMPLING_CTRL | COPROCESSOR_CTRL_DEMOD_Msk | COPROCESSOR_CTRL_BLOCK_Msk | \
   COPROCESSOR_CTRL_REF_ANGLE << COPROCESSOR_CTRL_REF_Pos)

static void adjust(const struct session* session) {
  const uint32_t turn = session->follower.turn;
  coprocessor_set_steps(follower_step_of_amplitudes(turn));
  COPROCESSOR->STEP_CU = follower_step_of_offsets(turn);
  COPROCESSOR->STEP_CV = follower_step_of_offsets(turn);
  COPROCESSOR->TURN_LIMIT = follower_watchdog(turn);
}

static void carry_out(const struct session* session, enum follower_task task) {
  switch (task) {
    case follower_nothing:
      return;
    case follower_freeze:
      coprocessor_set_steps(0);
      return;
    case follower_restart:
      COPROCESSOR->TURN_LIMIT = 1;
      return;
    case follower_adjust:
      adjust(session);
      return;
  }
}

static void keep_worst(struct session* session, uint64_t bound) {
  const uint32_t half_turn = UINT32_C(1) << 31;
  const uint32_t capped = bound < half_turn ? (uint32_t)bound : half_turn;
  if (session->locked_at != 0 && capped > session->worst) session->worst = capped;
}

// What the angles may have been off by from the last good turn on, with nothing but the drift that
// the sensor is said to have: 2^32 / 2 pi is a radian.
static void keep_blind(struct session* session, uint32_t samples) {
  const uint64_t a_second = ((uint64_t)settings.drift_per_s * 683565276) >> 32;
  const uint64_t drift = worst_of_all * a_second * samples / settings.rate_hz;
  keep_worst(session, session->bound + drift);
}

static void turn_was_good(struct session* session, uint32_t sample, uint32_t samples) {
  COPROCESSOR->CTRL = LEARNING | COPROCESSOR_CTRL_GUARD_Msk;
  const uint32_t since = sample - session->learnt;
  keep_blind(session, since > samples ? since - samples : 0);
  session->bound = judgement_bound_of_last(&session->judgement);
  session->learnt = sample;
  if (++session->turns == settings.turns) {
    session->locked_at = sample;
    session->judgement.settled = session->judgement.parameters;
    session->judgement.wandered = 0;
    COPROCESSOR->FLAGS = ERRORS_SINCE_LOCK;
    print_text("t ");
    print_unsigned(sample / settings.rate_hz, 4);
    print_text(" s: lock\n");
  }
}

// The evidence of a window, whole or not, that has just been looked at. What is no turn says
// nothing of the motion, but its samples have been guaranteed, too.
static void keep_evidence(struct session* session) {
  if (session->locked_at == 0) return;
  if (session->objection == NULL) session->objection = session->judgement.spoilt;
  keep_worst(session, judgement_bound_of_last(&session->judgement));
}

// Whether a window of the turn judge ended with this sample, and what follows.
static void look(struct session* session, uint32_t sample) {
  const uint32_t flags = COPROCESSOR->TURN_FLAGS;
  const uint32_t ended =
      (flags & COPROCESSOR_TURN_FLAGS_TURN_COUNT_Msk) >> COPROCESSOR_TURN_FLAGS_TURN_COUNT_Pos;
  const bool none = ended == session->judgement.ended;
  const uint32_t samples = COPROCESSOR->TURN_SAMPLES;
  judgement_look(&session->judgement);
  if (none) return;
  if ((flags & COPROCESSOR_TURN_FLAGS_GOOD_Msk) != 0) turn_was_good(session, sample, samples);
  keep_evidence(session);
  const bool timed_out = (flags & COPROCESSOR_TURN_FLAGS_TIMEOUT_Msk) != 0;
  carry_out(session, follower_turn_ended(&session->follower, samples, timed_out));
}

static void collect_errors(struct session* session) {
  const uint32_t always = COPROCESSOR_FLAGS_EARLY_Msk | COPROCESSOR_FLAGS_CONFIG_Msk;
  const uint32_t counting = session->locked_at != 0 ? always | ERRORS_SINCE_LOCK : always;
  session->errors |= COPROCESSOR->FLAGS & counting;
}

// To the end of the time or of the signal; the samples that were seen.
static uint32_t follow(struct session* session) {
  const uint32_t last = settings.seconds * settings.rate_hz;
  uint32_t sample = 1;
  for (; sample <= last; ++sample) {
    if (!sampling_wait(sample)) break;
    carry_out(session, follower_feed(&session->follower, COPROCESSOR->ANGLE));
    look(session, sample);
    if (session->locked_at != 0 && session->follower.resting) ++session->resting;
    if (sample % settings.rate_hz != 0) continue;
    collect_errors(session);
    const uint32_t second = sample / settings.rate_hz;
    if (second % settings.progress_seconds != 0) continue;
    const struct coprocessor_parameters parameters = coprocessor_read_parameters();
    print_progress(second, &parameters);
  }
  collect_errors(session);
  keep_blind(session, sample - 1 - session->learnt);
  return sample - 1;
}

static int conclude(const struct session* session, uint32_t samples) {
  if (session->locked_at == 0) return fail_because("follow", "too few good turns for a lock");
  if ((session->errors & COPROCESSOR_FLAGS_CLIP_Msk) != 0)
    return fail_because("follow", "the ADC clipped samples: reduce the gain");
  if ((session->errors & COPROCESSOR_FLAGS_ALARM_Msk) != 0)
    return fail_because("follow", "the signals have left their circle");
  const char* reason = error_sentence(session->errors);
  if (reason == NULL) reason = session->objection;
  if (reason != NULL) return fail_because("follow", reason);
  const uint64_t bound = judgement_with_harmonics(&session->judgement, session->worst);
  if (bound > settings.limit_deg)
    return fail_because("follow", "the evidence allows an angle error above limit_deg");
  const struct verdict_claim claim = {
      .bound = (uint32_t)bound,
      .samples = samples - session->locked_at,
      .motion = judgement_motion(&session->judgement),
      .unseen = settings.harmonics_deg,
      .conditions = judgement_conditions(&session->judgement, bound)};
  return pass_within("follow", &claim);
}

static void report(const struct session* session, uint32_t samples) {
  const struct coprocessor_parameters parameters = coprocessor_read_parameters();
  print_parameter_table(&parameters);
  print_text("good turns ");
  print_unsigned(session->turns, 0);
  if (session->locked_at != 0) {
    print_text(", at rest ");
    print_unsigned(session->resting, 0);
    print_text(" of ");
    print_unsigned(samples - session->locked_at, 0);
    print_text(" samples since the lock");
  }
  print_text("\n");
}

int main(void) {
  console_open(clock_frequency_hz(), settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("follow: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_text("follow: self-calibration of a sensor that drifts, at any speed\n");
  console_start_buffering();
  coprocessor_reset();
  if (!blocks_present()) {
    print_text("follow: this coprocessor has no block learning (the arithmetic paper has none)\n");
    return status_no_coprocessor;
  }
  sampling_count_oddities();
  if (!sampling_start(settings.rate_hz)) {
    print_text("follow: the ADC refuses the sampling rate\n");
    return status_refused;
  }
  const uint32_t turn = blocks_measure_turn(settings.measuring_seconds * settings.rate_hz);
  if (turn == 0) return fail_because("follow", "no turn seen");
  struct session session = {
      .follower = {.longest = settings.longest_turn_seconds * settings.rate_hz},
      .judgement = {.unseen = settings.harmonics_deg, .watches = true, .any_motion = true}};
  coprocessor_lock_by_turns();
  COPROCESSOR->CTRL = LEARNING;
  COPROCESSOR->TURN_LIMIT = follower_watchdog(turn);
  if (sampling_wait(1)) {
    follower_begin(&session.follower, turn, COPROCESSOR->ANGLE);
    adjust(&session);
  }
  const uint32_t samples = follow(&session);
  sampling_stop();
  judgement_finish(&session.judgement);
  keep_evidence(&session);
  if (samples < settings.seconds * settings.rate_hz) print_end(samples);
  report(&session, samples);
  return conclude(&session, samples);
}
