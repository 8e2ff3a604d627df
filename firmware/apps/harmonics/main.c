// Self-calibration with harmonics, at constant speed. The six parameters come from block learning,
// first with the angle as its own reference, then with a numeric one whose speed the program finds.
// The remaining error over the angle becomes the table of the harmonic correction.
//
// The table is the mean residue of whole turns. A shaft that runs unevenly in a way that repeats
// with each turn puts its own error into it, which the sensor's signals do not show: `ripple_deg`
// is what the user knows about that. The part of inertia falls with the square of the speed, and a
// second table at another speed (`second_speed_s`) tells it from the sensor's error.
//
// Status: 0 pass, 1 no turn or a verdict of fail, 2 the ADC refuses the settings,
// 3 no coprocessor on this board, or one without block learning or harmonic correction.
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "adc.h"
#include "angle_report.h"
#include "blocks.h"
#include "capsoc_device.h"
#include "clock.h"
#include "common_settings.h"
#include "console.h"
#include "coprocessor.h"
#include "error_table.h"
#include "fixed_print.h"
#include "parameter_report.h"
#include "program_settings.h"
#include "program_verdict.h"
#include "sampling.h"
#include "supervision.h"

#define SETTINGS(NUMBER, TEXT)                                                                \
  BAUD_SETTING(NUMBER)                                                                        \
  RATE_SETTING(NUMBER)                                                                        \
  NUMBER(uint32_t, measuring_seconds, 100, 1, 40000, 1, "s", "that the first turns may take") \
  NUMBER(uint32_t, turns, 5, 4, 1e6, 1, "", "of learning with the angle as reference")        \
  NUMBER(uint32_t, table_turns, 4, 1, 1e4, 1, "", "of learning the table")                    \
  NUMBER(uint32_t, ripple_deg, 180, 0, 180, WORDS_PER_DEGREE, "deg",                          \
         "uneven motion that repeats with each turn, at most; 180: not known")                \
  NUMBER(uint32_t, second_speed_s, 0, 0, 40000, 1, "s",                                       \
         "to wait for another speed of the shaft and learn there, too; 0: one speed")         \
  CALIBRATION_SETTING(NUMBER)                                                                 \
  LIMIT_SETTING(NUMBER)                                                                       \
  ANGLE_STRIDE_SETTING(NUMBER)
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3, speed_rounds = 3, margin = 8 };

// Of the speed, from one round to the next.
#define STEADY 1e-4

#define FROZEN SAMPLING_CTRL
#define LEARNING (SAMPLING_CTRL | COPROCESSOR_CTRL_DEMOD_Msk | COPROCESSOR_CTRL_BLOCK_Msk)

static const char name[] = "harmonics";
static const char ended[] = "the signal ended too early";
static const char no_turn[] = "no turn seen, or fewer than 22 samples in it";

static uint32_t windows(void) {
  return (COPROCESSOR->TURN_FLAGS & COPROCESSOR_TURN_FLAGS_TURN_COUNT_Msk) >>
         COPROCESSOR_TURN_FLAGS_TURN_COUNT_Pos;
}

static uint32_t magnitude(int32_t value) {
  return value < 0 ? 0 - (uint32_t)value : (uint32_t)value;
}

// Sleeps until the next result, and supervises once a second. False if the signal ended.
static bool next_sample(struct supervision* state) {
  if (!sampling_wait(sampling_count() + 1)) return false;
  if (sampling_count() % state->rate_hz == 0) supervise(state, sampling_count());
  return true;
}

// Until one more window has ended.
static bool wait_window(struct supervision* state) {
  for (const uint32_t before = windows(); windows() == before;)
    if (!next_sample(state)) return false;
  return true;
}

// The parameters with the angle as its own reference: in the end the bias of the harmonics is in
// them. Samples of a turn; 0 if the signal ended before.
static uint32_t learn_by_angle(struct supervision* state, uint32_t turn) {
  uint32_t control = LEARNING | COPROCESSOR_CTRL_REF_ANGLE << COPROCESSOR_CTRL_REF_Pos;
  blocks_watch(turn);
  blocks_set_steps(turn, 2);
  COPROCESSOR->CTRL = control;
  for (uint32_t i = 1; i <= settings.turns; ++i) {
    if (!wait_window(state)) return 0;
    const uint32_t good = COPROCESSOR->TURN_FLAGS & COPROCESSOR_TURN_FLAGS_GOOD_Msk;
    if (good != 0) turn = COPROCESSOR->TURN_SAMPLES;
    // The angle of coefficients that were never learnt need not go round.
    if (good != 0 && i >= 2) control |= COPROCESSOR_CTRL_GUARD_Msk;
    COPROCESSOR->CTRL = control;
    blocks_set_steps(turn, i % 2 == 0 ? 2 : 1);
    const struct coprocessor_parameters parameters = coprocessor_read_parameters();
    print_progress(sampling_count() / settings.rate_hz, &parameters);
  }
  return turn;
}

// The numeric reference continues where the angle is, with the speed of the last turn. Samples of a
// turn; 0 if there was no turn.
static uint32_t to_numeric_reference(struct supervision* state, uint32_t control) {
  const int64_t travel = (int64_t)COPROCESSOR->WINDING * (1 << 18);
  const uint32_t samples = COPROCESSOR->TURN_SAMPLES;
  if (samples < 22 || magnitude(COPROCESSOR->WINDING) < UINT32_C(1) << 29) return 0;
  const int64_t frequency = travel / (int64_t)samples;
  coprocessor_set_frequency(frequency);
  coprocessor_set_phase(((uint64_t)COPROCESSOR->REF_PHASE << 16) + (uint64_t)frequency);
  COPROCESSOR->CTRL = control;
  blocks_watch(samples);
  blocks_set_steps(samples, 1);
  state->judgement.numeric = true;
  state->judgement.idle_turns = 2;  // those of correct_speed
  judgement_disturbed(&state->judgement);
  return samples;
}

// A turn's block, whose result the coprocessor takes over with the samples after it.
static bool learn_block(struct supervision* state) {
  COPROCESSOR->CTRL = LEARNING;
  if (!wait_window(state) || !wait_window(state)) return false;
  for (int i = 0; i < 2; ++i)
    if (!next_sample(state)) return false;
  judgement_look(&state->judgement);  // while it learns: what it has added counts
  COPROCESSOR->CTRL = FROZEN;
  return true;
}

static bool add_residues(struct supervision* state, uint32_t samples, int64_t* sum) {
  for (uint32_t i = 0; i < samples; ++i) {
    if (!next_sample(state)) return false;
    if (sum != NULL) *sum += COPROCESSOR->RESIDUE;
  }
  return true;
}

// Q-format of coprocessor_set_frequency
struct pace {
  double sum, before;
  int count;
};

// The residue drifts by what the speed is off: the same part of two turns, so that harmonics
// cancel. It ends before the second turn does, and the next block begins with the third.
static bool correct_speed(struct supervision* state, uint32_t turn, struct pace* pace) {
  const uint32_t part = turn - 2 * margin;
  int64_t first = 0, second = 0;
  if (!add_residues(state, part, &first) || !add_residues(state, turn - part, NULL) ||
      !add_residues(state, part, &second))
    return false;
  const double drift = (double)(second - first) / part / turn;
  const double measured = (double)coprocessor_frequency() + drift * 0x1p16;
  pace->sum += measured;
  ++pace->count;
  // Of a steady shaft the last measurement is the best one, of an unsteady one the mean of all.
  const double mean = pace->sum / pace->count;
  const bool steady = fabs(measured - pace->before) < STEADY * fabs(measured);
  pace->before = measured;
  coprocessor_set_frequency((int64_t)(steady ? measured : mean));
  return true;
}

// Null, or why there are none.
static const char* learn_nodes(struct supervision* state, uint32_t turn,
                               int32_t nodes[error_nodes]) {
  static struct error_table table;
  table = (struct error_table){0};
  for (uint32_t i = 0; i < turn * settings.table_turns; ++i) {
    if (!next_sample(state)) return ended;
    error_table_add(&table, COPROCESSOR->ANGLE, COPROCESSOR->RESIDUE);
  }
  return error_table_nodes(&table, nodes);
}

// With the angle as reference, until two turns have the same length, and not that of before: a
// quarter more or less. False if that did not happen in time.
static bool wait_for_another_speed(struct supervision* state, uint32_t turn) {
  const uint32_t begin = sampling_count();
  COPROCESSOR->CTRL = FROZEN | COPROCESSOR_CTRL_REF_ANGLE << COPROCESSOR_CTRL_REF_Pos;
  COPROCESSOR->TURN_LIMIT = 0;
  for (uint32_t before = 0;;) {
    if (!wait_window(state)) return false;
    if ((sampling_count() - begin) / settings.rate_hz >= settings.second_speed_s) return false;
    const uint32_t now = COPROCESSOR->TURN_SAMPLES;
    const uint32_t change = now > before ? now - before : before - now;
    const bool another = now / 5 > turn / 4 || now / 4 < turn / 5;
    if (another && change <= now / 100) return true;
    before = now;
  }
}

// The table again, of the same coefficients. With k the square of the speeds' ratio the first
// has k times the second's share of inertia.
static const char* learn_again(struct supervision* state, uint32_t turn,
                               int32_t nodes[error_nodes]) {
  static int32_t first[error_nodes];
  const double speed = (double)coprocessor_frequency();
  for (int i = 0; i < error_nodes; ++i) first[i] = nodes[i];
  if (!wait_for_another_speed(state, turn))
    return "the shaft did not come to another speed in time";
  turn = to_numeric_reference(state, FROZEN);
  if (turn == 0) return no_turn;
  struct pace pace = {0};
  for (int round = 0; round < speed_rounds; ++round)
    if (!correct_speed(state, turn, &pace)) return ended;
  const char* const objection = learn_nodes(state, turn, nodes);
  if (objection != NULL) return objection;
  const double ratio = (double)coprocessor_frequency() / speed, k = ratio * ratio;
  return error_table_without_inertia(first, nodes, k);
}

// Between two samples; what meets one is refused and comes again.
static bool write_nodes(const int32_t nodes[error_nodes]) {
  COPROCESSOR->FLAGS = COPROCESSOR_FLAGS_CONFIG_Msk;
  for (uint32_t i = 0, tries = 0; i < error_nodes;) {
    COPROCESSOR->CORRECTION = i << COPROCESSOR_CORRECTION_NODE_Pos |
                              ((uint32_t)nodes[i] & COPROCESSOR_CORRECTION_VALUE_Msk);
    if ((COPROCESSOR->FLAGS & COPROCESSOR_FLAGS_CONFIG_Msk) == 0) {
      ++i;
      continue;
    }
    COPROCESSOR->FLAGS = COPROCESSOR_FLAGS_CONFIG_Msk;
    if (++tries > 100000) return false;
  }
  return true;
}

// Words of 2^-24 turn, in 2^-32 turn.
static uint32_t largest(const int32_t nodes[error_nodes]) {
  uint32_t most = 0;
  for (int i = 0; i < error_nodes; ++i)
    if (magnitude(nodes[i]) > most) most = magnitude(nodes[i]);
  return most << 8;
}

// Largest error that the shaft's motion may have put into the table, 2^-32 turn. If the motion is
// unknown, that is the whole table and what the sensor's own harmonics may have hidden. The radius
// shows half of the latter.
static uint32_t unseen(const struct judgement* judgement, uint32_t table) {
  uint64_t most = table;
  for (uint32_t i = 0; i < judgement_turns; ++i)
    if (table + 2 * (uint64_t)judgement->turns[i].radius > most)
      most = table + 2 * (uint64_t)judgement->turns[i].radius;
  return most < settings.ripple_deg ? (uint32_t)most : settings.ripple_deg;
}

// Everything up to the corrected angle. Null, or why there is none.
static const char* calibrate(struct supervision* state, uint32_t turn) {
  static int32_t nodes[error_nodes];
  if (learn_by_angle(state, turn) == 0) return ended;
  turn = to_numeric_reference(state, LEARNING);
  if (turn == 0) return no_turn;
  struct pace pace = {0};
  for (int round = 0; round < speed_rounds; ++round)
    if (!learn_block(state) || !correct_speed(state, turn, &pace)) return ended;
  if (!learn_block(state)) return ended;
  const struct coprocessor_parameters stored = coprocessor_read_parameters();
  coprocessor_load_parameters(&stored);
  print_parameter_table(&stored);
  const char* objection = learn_nodes(state, turn, nodes);
  if (objection == NULL && settings.second_speed_s != 0)
    objection = learn_again(state, turn, nodes);
  if (objection != NULL) return objection;
  if (!write_nodes(nodes)) return "the samples leave no time to write the table";
  print_text("harmonics: the table takes off up to ");
  print_degrees(largest(nodes), 0);
  print_text(" deg\n");
  COPROCESSOR->CTRL = FROZEN | COPROCESSOR_CTRL_CORRECT_Msk;
  judgement_disturbed(&state->judgement);
  state->judgement.corrected = true;
  static struct steering steering;
  state->judgement.steering = &steering;
  for (int i = 0; i <= judgement_turns; ++i) {
    if (!wait_window(state)) return ended;
    judgement_look(&state->judgement);
  }
  state->judgement.unseen = unseen(&state->judgement, largest(nodes));
  return NULL;
}

int main(void) {
  const uint32_t clock_hz = clock_frequency_hz();
  console_open(clock_hz, settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("harmonics: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_text("harmonics: self-calibration with the sensor's harmonics\n");
  console_start_buffering();
  coprocessor_reset();
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_CORRECT_Msk;
  if ((COPROCESSOR->CTRL & COPROCESSOR_CTRL_CORRECT_Msk) == 0 || !blocks_present()) {
    print_text("harmonics: this coprocessor corrects none (the arithmetic paper does not)\n");
    return status_no_coprocessor;
  }
  COPROCESSOR->CTRL = 0;
  if (!sampling_start(settings.rate_hz)) {
    print_text("harmonics: the ADC refuses the sampling rate\n");
    return status_refused;
  }
  const uint32_t turn = blocks_measure_turn(settings.measuring_seconds * settings.rate_hz);
  if (turn == 0) return fail_because(name, "no turn seen");
  coprocessor_lock_by_turns();
  struct supervision state = {.name = name,
                              .rate_hz = settings.rate_hz,
                              .mirror_seconds = UINT32_MAX,
                              .judgement = {.limit = settings.limit_deg, .fewest = 2}};
  const char* const reason = calibrate(&state, turn);
  if (reason != NULL) {
    sampling_stop();
    return fail_because(name, reason);
  }
  const uint32_t learnt = sampling_count();
  judgement_cover(&state.judgement);
  if (!print_angles(&state.judgement, learnt, settings.calibration_samples, settings.angle_stride))
    print_end(sampling_count());
  sampling_stop();
  judgement_finish(&state.judgement);
  return verdict(&state);
}
