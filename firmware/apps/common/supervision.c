#include "supervision.h"

#include <stddef.h>

#include "capsoc_device.h"
#include "coprocessor.h"
#include "fixed_print.h"
#include "parameter_report.h"
#include "program_verdict.h"
#include "sampling.h"

// SAT and DIVERGED belong to a cold start: coefficients of 0 leave the whole signal as error. They
// count while there is a lock. EARLY and CONFIG are wrong at any time.
#define TRANSIENT_FLAGS (COPROCESSOR_FLAGS_SAT_Msk | COPROCESSOR_FLAGS_DIVERGED_Msk)
#define LASTING_FLAGS (COPROCESSOR_FLAGS_EARLY_Msk | COPROCESSOR_FLAGS_CONFIG_Msk)

static void report(const struct supervision* state, uint32_t samples, const char* text) {
  print_text("t ");
  print_unsigned(samples / state->rate_hz, 4);
  print_text(text);
}

// With a turn that fits: an average error of a quarter of the smaller amplitude is no lock,
// whatever the turns say.
static void set_lock_threshold(const struct supervision* state) {
  if (state->judgement.before == 0) return;
  const int32_t a1 = state->judgement.parameters.a1, a2 = state->judgement.parameters.a2;
  COPROCESSOR->LOCK_THRESHOLD = (uint32_t)(a1 < a2 ? a1 : a2) / 4;
}

static void collect_errors(struct supervision* state) {
  const uint32_t counting = state->locked_at != 0 ? TRANSIENT_FLAGS | LASTING_FLAGS : LASTING_FLAGS;
  state->errors |= COPROCESSOR->FLAGS & counting;
}

static void follow_lock(struct supervision* state, uint32_t samples, bool locked) {
  if (locked && state->locked_at == 0) {
    state->locked_at = samples;
    state->errors &= ~TRANSIENT_FLAGS;  // those of a lock that was lost: it learnt on
    COPROCESSOR->FLAGS = TRANSIENT_FLAGS;
    report(state, samples, " s: lock\n");
  } else if (!locked && state->locked_at != 0) {
    state->locked_at = 0;
    report(state, samples, " s: lock lost\n");
  }
}

static uint32_t turn_of_reference(void) {
  const int64_t frequency = coprocessor_frequency();
  const uint64_t speed = (uint64_t)(frequency < 0 ? -frequency : frequency);
  const uint64_t turn = speed != 0 ? (UINT64_C(1) << 48) / speed + 1 : UINT32_MAX;
  return turn < UINT32_MAX ? (uint32_t)turn : UINT32_MAX;
}

uint32_t supervision_period(const struct supervision* state) {
  if (!state->judgement.numeric) return state->rate_hz;
  const uint32_t turn = turn_of_reference();
  return turn < state->rate_hz ? turn : state->rate_hz;
}

// Samples that MIRROR stands until it is believed. A demodulation is as many turns as the sensor
// needs: of a fast shaft it is over in seconds.
static uint64_t mirror_samples(const struct supervision* state) {
  const uint64_t given = (uint64_t)state->mirror_seconds * state->rate_hz;
  if (!state->judgement.numeric) return given;
  const uint32_t turn = turn_of_reference();
  return turn < given ? turn : given;
}

static bool seems_reversed(struct supervision* state, uint32_t samples, bool mirror) {
  if (!mirror) {
    state->mirror_since = 0;
    return false;
  }
  if (state->mirror_since == 0) state->mirror_since = samples;
  return samples - state->mirror_since >= mirror_samples(state);
}

bool supervise(struct supervision* state, uint32_t samples) {
  const uint32_t status = COPROCESSOR->STATUS;
  collect_errors(state);
  judgement_look(&state->judgement);
  set_lock_threshold(state);
  follow_lock(state, samples, (status & COPROCESSOR_STATUS_LOCK_Msk) != 0);
  if (!seems_reversed(state, samples, (status & COPROCESSOR_STATUS_MIRROR_Msk) != 0)) return false;
  coprocessor_reverse_reference();
  COPROCESSOR->LOCK_THRESHOLD = UINT32_MAX;
  judgement_restart(&state->judgement);
  COPROCESSOR->FLAGS = TRANSIENT_FLAGS;
  report(state, samples, " s: rotation is reversed: reference turned round\n");
  state->mirror_since = 0;
  state->locked_at = 0;  // the demodulation starts again, from the mirrored coefficients
  return true;
}

bool demodulate(struct supervision* state, uint32_t samples, uint32_t progress_seconds) {
  uint32_t next_line = progress_seconds;
  const uint32_t period = supervision_period(state);
  for (uint32_t now = 0; now < samples;) {
    now = samples - now < period ? samples : now + period;
    if (!judgement_until(&state->judgement, now)) return false;
    supervise(state, now);
    if (state->goes_on != NULL && !state->goes_on(state)) return false;
    if (now / state->rate_hz < next_line) continue;
    next_line += progress_seconds;
    const struct coprocessor_parameters parameters = coprocessor_read_parameters();
    print_progress(now / state->rate_hz, &parameters);
  }
  return true;
}

const char* error_sentence(uint32_t errors) {
  if ((errors & COPROCESSOR_FLAGS_EARLY_Msk) != 0)
    return "samples came too early and were lost (EARLY)";
  if ((errors & COPROCESSOR_FLAGS_CONFIG_Msk) != 0)
    return "the coprocessor refused a setting (CONFIG)";
  if ((errors & COPROCESSOR_FLAGS_DIVERGED_Msk) != 0)
    return "the error was a quarter of full scale or more (DIVERGED)";
  if ((errors & COPROCESSOR_FLAGS_SAT_Msk) != 0) return "a value saturated after the lock (SAT)";
  return NULL;
}

int pass(const char* name, const struct judgement* judgement) {
  struct verdict_claim claim = {.bound = judgement_bound(judgement),
                                .samples = judgement_covered(judgement),
                                .motion = judgement_motion(judgement),
                                .unseen = judgement->unseen};
  claim.conditions = judgement_conditions(judgement, claim.bound);
  return pass_within(name, &claim);
}

int verdict(struct supervision* state) {
  collect_errors(state);
  const bool locked = state->locked_at != 0;
  if (locked) {
    print_text(state->name);
    print_text(": lock at ");
    print_unsigned(state->locked_at / state->rate_hz, 0);
    print_text(" s\n");
  }
  const char* reason = judgement_objection(&state->judgement);
  if (reason == NULL) reason = error_sentence(state->errors);
  if (reason == NULL && !locked) reason = "no lock";
  if (reason != NULL) return fail_because(state->name, reason);
  return pass(state->name, &state->judgement);
}
