#include "judgement.h"

#include <stddef.h>

#include "capsoc_device.h"
#include "program_verdict.h"
#include "sampling.h"

// 2^32 / 2 pi: a radian in 2^-32 turn.
#define RADIAN UINT64_C(683565276)
// Limits of the drift in a turn (0.05, as relative change or radians) and of nothing else: those of
// the radius, the winding and the rest are the coprocessor's.
#define DRIFT_LIMIT (RADIAN / 20)
// Turns with parameters that differ by more than this (0.001) are not compared with one another.
#define SAME_PARAMETERS (RADIAN / 1000)
// Fewer samples of 0 in both channels may be the place where the circle crosses 0.
#define ZEROS_LIMIT 3
// Chance repeats 1 of 250 samples of 12 bits at an amplitude of 0.02.
#define REPEATS_LIMIT(samples) ((samples) / 64 + 2)
// Turns for which a drift that does not get smaller may continue, and may have continued before.
#define LONGEST_DRIFT 16
#define HALF_TURN (UINT32_C(1) << 31)
// Of phi in a settled loop, 2^-32 turn.
#define ROUNDINGS 8

static uint32_t field(uint32_t word, uint32_t mask, uint32_t position) {
  return (word & mask) >> position;
}

static uint32_t capped(uint64_t value) {
  return value < HALF_TURN ? (uint32_t)value : HALF_TURN;
}

static uint32_t larger(uint32_t one, uint32_t other) {
  return one > other ? one : other;
}

static uint32_t magnitude(int32_t value) {
  return value < 0 ? 0 - (uint32_t)value : (uint32_t)value;
}

// part / whole as an angle; half a turn if the whole is 0.
static uint32_t ratio(uint32_t part, uint32_t whole) {
  if (whole == 0) return HALF_TURN;
  return capped((part * RADIAN + whole - 1) / whole);
}

static uint32_t difference(int32_t one, int32_t other) {
  return one > other ? (uint32_t)one - (uint32_t)other : (uint32_t)other - (uint32_t)one;
}

static int32_t wrapped(int32_t one, int32_t other) {
  return (int32_t)((uint32_t)one - (uint32_t)other);
}

// Without phi.
static struct coprocessor_parameters minus(const struct coprocessor_parameters* one,
                                           const struct coprocessor_parameters* other) {
  return (struct coprocessor_parameters){.a1 = wrapped(one->a1, other->a1),
                                         .a2 = wrapped(one->a2, other->a2),
                                         .b1 = wrapped(one->b1, other->b1),
                                         .b2 = wrapped(one->b2, other->b2),
                                         .beta = wrapped(one->beta, other->beta)};
}

// Phi may drift: it says where the reference is, not what the sensor is.
static uint32_t drift_between(const struct coprocessor_parameters* before,
                              const struct coprocessor_parameters* now) {
  const uint32_t a1 = magnitude(now->a1), a2 = magnitude(now->a2);
  uint32_t drift = magnitude((int32_t)(now->beta - before->beta));
  drift = larger(drift, ratio(difference(now->a1, before->a1), a1));
  drift = larger(drift, ratio(difference(now->a2, before->a2), a2));
  drift = larger(drift, ratio(difference(now->b1, before->b1), a1));
  return larger(drift, ratio(difference(now->b2, before->b2), a2));
}

static bool by_count(void) {
  return (COPROCESSOR->JUDGE & COPROCESSOR_JUDGE_COUNT_Msk) != 0;
}

void judgement_disturbed(struct judgement* judgement) {
  judgement->cut = true;
}

void judgement_restart(struct judgement* judgement) {
  judgement->discard = 1;
  judgement->cut = false;
  judgement->before = 0;
  judgement->spoilt = NULL;
  judgement->learning_turns = 0;
  judgement->phi_turns = 0;
  judgement->phi_change = 0;
  judgement->slip = 0;
  evenness_restart(&judgement->evenness);
}

// The coprocessor's word, or nothing against the window but that it was mirrored as expected, or
// that it was cut short.
static bool good(const struct judgement* judgement, const struct turn_evidence* turn) {
  const uint32_t flags = turn->flags;
  if ((flags & COPROCESSOR_TURN_FLAGS_GOOD_Msk) != 0) return true;
  uint32_t bad = COPROCESSOR_TURN_FLAGS_CLIPPED_Msk | COPROCESSOR_TURN_FLAGS_SAT_Msk |
                 COPROCESSOR_TURN_FLAGS_NOANGLE_Msk | COPROCESSOR_TURN_FLAGS_RADIUS_Msk |
                 COPROCESSOR_TURN_FLAGS_RESIDUE_Msk;
  if (judgement->any_motion) return (flags & bad) == 0;
  if (!judgement->mirrored) bad |= COPROCESSOR_TURN_FLAGS_MIRROR_Msk;
  if (!turn->whole) return (flags & bad) == 0;
  bad |= COPROCESSOR_TURN_FLAGS_TIMEOUT_Msk;
  if (!by_count()) bad |= COPROCESSOR_TURN_FLAGS_WINDING_Msk;
  const uint32_t octants = COPROCESSOR_TURN_FLAGS_OCTANTS_Msk;
  return (flags & bad) == 0 && (flags & octants) == octants;
}

// Whether the angle has not gone round as a turn does.
static bool moved_otherwise(const struct turn_evidence* turn) {
  const uint32_t octants = COPROCESSOR_TURN_FLAGS_OCTANTS_Msk;
  const uint32_t motion = COPROCESSOR_TURN_FLAGS_TIMEOUT_Msk | COPROCESSOR_TURN_FLAGS_WINDING_Msk |
                          COPROCESSOR_TURN_FLAGS_MIRROR_Msk;
  return turn->whole && ((turn->flags & motion) != 0 || (turn->flags & octants) != octants);
}

// The raw samples know what a loop that fits nothing cannot tell. Null if they say no more than the
// flags.
static const char* cause_by_shape(const struct judgement* judgement,
                                  const struct turn_evidence* turn) {
  struct signal_ellipse ellipse;
  switch (signal_shape_kind(&judgement->shape, &ellipse)) {
    case signal_at_rest:
      return "both channels stand still: the shaft rests, or the sensor is dead";
    case signal_u_dead:
      return "channel U stands still while V moves: look for a dead or constant channel";
    case signal_v_dead:
      return "channel V stands still while U moves: look for a dead or constant channel";
    case signal_same:
      return "the channels carry the same signal: look for a short circuit between them";
    case signal_elliptic:
      if (!moved_otherwise(turn) || by_count()) return NULL;
      if (judgement->numeric)
        return "the samples are a sensor's, but the shaft does not turn at frequency_hz: it rests, "
               "swings or has another speed";
      return "the samples are a sensor's, but the shaft makes no whole turns in time: it rests, "
             "swings or is too slow";
    default:
      return NULL;
  }
}

// The plainest cause first: what makes the others.
static const char* cause_of(const struct judgement* judgement, const struct turn_evidence* turn) {
  static const struct {
    uint32_t flag;
    const char* sentence;
  } causes[] = {
      {COPROCESSOR_TURN_FLAGS_SAT_Msk, "a value in the coprocessor saturated in the last turns"},
      {COPROCESSOR_TURN_FLAGS_NOANGLE_Msk,
       "the signals give no angle: look for a dead or constant channel"},
      {COPROCESSOR_TURN_FLAGS_RADIUS_Msk,
       "the calibrated signals do not stay on a circle: noise, harmonics or a broken channel"},
      {COPROCESSOR_TURN_FLAGS_RESIDUE_Msk,
       "the angle leaves its reference by 22.5 degrees or more: stale samples or an uneven shaft"},
      {COPROCESSOR_TURN_FLAGS_TIMEOUT_Msk,
       "no whole turn was seen in time: the shaft rests or is too slow"},
      {COPROCESSOR_TURN_FLAGS_WINDING_Msk,
       "the angle does not go round once a turn: is the speed right?"},
      {COPROCESSOR_TURN_FLAGS_MIRROR_Msk, "the rotation is the other way round"},
  };
  if ((turn->flags & COPROCESSOR_TURN_FLAGS_CLIPPED_Msk) != 0)
    return "the ADC clipped samples of the last turns: reduce the gain";
  const char* const shape = cause_by_shape(judgement, turn);
  if (shape != NULL) return shape;
  uint32_t flags = turn->flags;
  if (by_count() || !turn->whole) flags &= ~COPROCESSOR_TURN_FLAGS_WINDING_Msk;
  for (size_t i = 0; i < sizeof causes / sizeof causes[0]; ++i)
    if ((flags & causes[i].flag) != 0) return causes[i].sentence;
  return "parts of the turn had no samples: the shaft rests or swings";
}

static const char* objection_to(const struct judgement* judgement,
                                const struct turn_evidence* turn) {
  if (!good(judgement, turn)) return cause_of(judgement, turn);
  if (turn->zeros >= ZEROS_LIMIT)
    return "samples are 0 in both channels again and again: the converter drops out";
  if (judgement->shuffled && turn->repeats >= REPEATS_LIMIT(turn->samples))
    return "samples come again bit for bit: the converter or its link holds old ones";
  if (turn->drift >= DRIFT_LIMIT && !judgement->any_motion)
    return "the parameters still drift by 5 % a turn or more";
  return NULL;
}

static void keep_worst(struct turn_evidence* worst, const struct turn_evidence* turn) {
  worst->radius = larger(worst->radius, turn->radius);
  worst->residue = larger(worst->residue, turn->residue);
  worst->drift = larger(worst->drift, turn->drift);
  worst->jump = larger(worst->jump, turn->jump);
}

static void cover(struct judgement* judgement, const struct turn_evidence* turn) {
  keep_worst(&judgement->worst, turn);
  judgement->samples += turn->samples;
  if (judgement->objection == NULL) judgement->objection = objection_to(judgement, turn);
  if (turn->whole) ++judgement->whole;
}

// A window that is cut short before anything is covered ends the row of whole ones.
static void keep_before(struct judgement* judgement, const struct turn_evidence* turn) {
  judgement->last = *turn;
  judgement->spoilt = objection_to(judgement, turn);
  if (!turn->whole || judgement->spoilt != NULL) {
    judgement->before = 0;
    return;
  }
  for (uint32_t i = judgement_turns - 1; i > 0; --i) judgement->turns[i] = judgement->turns[i - 1];
  judgement->turns[0] = *turn;
  if (judgement->before < judgement_turns) ++judgement->before;
}

static bool settles(const struct judgement* judgement) {
  const uint64_t last = judgement->learning[0], before = judgement->learning[1];
  return before > last && before >= 2 * last && judgement->learning[2] >= 2 * before;
}

// Of the last turns of learning. What goes to and fro from turn to turn, by noise or an uneven
// shaft, goes nowhere: the sum of the changes counts.
static uint64_t way_of(const struct judgement* judgement, uint32_t turns) {
  struct coprocessor_parameters begin = judgement->parameters;
  for (uint32_t i = 0; i < turns; ++i) begin = minus(&begin, &judgement->change[i]);
  return drift_between(&begin, &judgement->parameters);
}

// What the parameters are off by, if they went and continue as in these turns.
static uint64_t going_on(const struct judgement* judgement, uint64_t way, uint32_t turns) {
  return LONGEST_DRIFT * way / (turns * (judgement->idle_turns + 1));
}

// What the parameters may still be off by, if their last changes continue as they were. The changes
// of a loop that settles shrink from turn to turn. Those of a drift, or of another signal at almost
// the same speed, do not.
static uint64_t wander(const struct judgement* judgement) {
  if (judgement->learning_turns < learning_judged || by_count()) return 0;
  if (!settles(judgement))
    return going_on(judgement, way_of(judgement, learning_judged), learning_judged);
  const uint64_t last = judgement->learning[0];
  return last * last / (judgement->learning[1] - last);
}

// The same, if it is a drift: noise in each of the turns leads no further than in one, rarely by
// twice the root of the mean square.
static uint64_t drift_of(const struct judgement* judgement, uint32_t turns) {
  const uint64_t way = way_of(judgement, turns);
  double squares = 0;
  for (uint32_t i = 0; i < turns; ++i)
    squares += (double)judgement->learning[i] * (double)judgement->learning[i];
  return (double)way * (double)way * turns > 4 * squares ? going_on(judgement, way, turns) : 0;
}

// Many turns show a drift that is small compared with the noise, few one that came after larger
// changes.
static uint64_t steady_drift(const struct judgement* judgement) {
  const uint32_t turns = judgement->learning_turns;
  if (turns < learning_judged || by_count() || settles(judgement)) return 0;
  const uint64_t few = drift_of(judgement, learning_judged), many = drift_of(judgement, turns);
  return few > many ? few : many;
}

// Of turns with demodulation: a drift that does not become smaller continues.
static void keep_learning(struct judgement* judgement, uint32_t drift,
                          const struct coprocessor_parameters* before) {
  if (drift == 0) return;  // nothing was learnt in it
  for (uint32_t i = learning_kept - 1; i > 0; --i) {
    judgement->learning[i] = judgement->learning[i - 1];
    judgement->change[i] = judgement->change[i - 1];
  }
  judgement->learning[0] = drift;
  judgement->change[0] = minus(&judgement->parameters, before);
  if (judgement->learning_turns < learning_kept) ++judgement->learning_turns;
  if (drift >= SAME_PARAMETERS) evenness_restart(&judgement->evenness);
  if (!judgement->any_motion) return;
  const uint32_t wandered = drift_between(&judgement->settled, &judgement->parameters);
  judgement->wandered = larger(judgement->wandered, wandered);
}

// A loop that settles has changes that shrink; what is beyond 0.6 of the largest before, in a turn,
// is the reference's or the samples'.
static void follow_phi(struct judgement* judgement) {
  const int32_t change = (int32_t)(judgement->parameters.phi - judgement->phi);
  judgement->phi = judgement->parameters.phi;
  if (++judgement->phi_turns < 2) return;
  for (uint32_t i = learning_judged - 1; i > 0; --i)
    judgement->phi_way[i] = judgement->phi_way[i - 1];
  judgement->phi_way[0] = change;
  const uint32_t settling = judgement->phi_change - judgement->phi_change / 5 * 2;
  const uint32_t size = magnitude(change);
  judgement->phi_change = larger(size, settling);
  if (judgement->phi_turns < 4 || size <= settling) return;
  judgement->slip += change < 0 ? -(int64_t)(size - settling) : size - settling;
}

static struct turn_evidence read_window(struct judgement* judgement, uint32_t flags) {
  const struct coprocessor_parameters parameters = coprocessor_read_parameters();
  struct turn_evidence turn = {
      .flags = flags,
      .samples = COPROCESSOR->TURN_SAMPLES,
      .radius = ratio(COPROCESSOR->RADIUS_MAX, magnitude(COPROCESSOR->TURN_DET)),
      .residue = COPROCESSOR->RESIDUE_MAX,
      .drift = judgement->has_parameters ? drift_between(&judgement->parameters, &parameters)
                                         : HALF_TURN,
      .zeros = sampling_zeros() - judgement->zeros,
      .repeats = sampling_repeats() - judgement->repeats,
      .whole = !judgement->cut,
  };
  judgement->zeros += turn.zeros;
  judgement->repeats += turn.repeats;
  judgement->parameters = parameters;
  judgement->has_parameters = true;
  return turn;
}

static void look_at_shape(struct judgement* judgement) {
  struct sampling_probe probe;
  while (sampling_take_probe(&probe)) signal_shape_feed(&judgement->shape, probe.u, probe.v);
}

void judgement_look(struct judgement* judgement) {
  if (judgement->watches) {
    const uint32_t now = sampling_count();
    evenness_feed(&judgement->evenness, COPROCESSOR->ANGLE, now - judgement->watched);
    judgement->watched = now;
  }
  look_at_shape(judgement);
  const uint32_t flags = COPROCESSOR->TURN_FLAGS;
  const uint32_t ended =
      field(flags, COPROCESSOR_TURN_FLAGS_TURN_COUNT_Msk, COPROCESSOR_TURN_FLAGS_TURN_COUNT_Pos);
  const uint32_t fresh = (ended - judgement->ended) & 0xFF;
  if (fresh == 0) return;
  judgement->ended = ended;
  const struct coprocessor_parameters before = judgement->parameters;
  struct turn_evidence turn = read_window(judgement, flags);
  judgement->cut = false;
  const uint32_t discard = judgement->discard;
  judgement->discard = 0;
  if (judgement->watches) {
    const bool even = turn.whole && fresh == 1 && discard == 0 && good(judgement, &turn);
    const uint32_t excess = evenness_excess(&judgement->evenness);
    const uint32_t jump = evenness_end_window(&judgement->evenness, even);
    turn.jump = judgement->any_motion ? excess : jump;
  }
  if (fresh <= discard) return;
  if (fresh - discard > 1) {
    judgement->before = 0;
    if (judgement->covers && judgement->objection == NULL)
      judgement->objection = "turns ended without being looked at: lower rate_hz";
  }
  if ((COPROCESSOR->CTRL & COPROCESSOR_CTRL_DEMOD_Msk) != 0 && turn.whole) {
    keep_learning(judgement, turn.drift, &before);
    if (judgement->numeric && good(judgement, &turn)) follow_phi(judgement);
  }
  if (judgement->covers)
    cover(judgement, &turn);
  else
    keep_before(judgement, &turn);
  if (turn.whole) ++judgement->judged;
  if (turn.whole && judgement->steering != NULL)
    steering_end_turn(judgement->steering, turn.samples, turn.residue);
}

void judgement_cover(struct judgement* judgement) {
  judgement_look(judgement);  // what has ended until now is not covered
  judgement->covers = true;
}

// Samples in which no more than one window ends.
static uint32_t stride(const struct judgement* judgement) {
  if (judgement->watches) return 1;
  uint64_t shortest = COPROCESSOR->TURN_LIMIT / 6;  // it is 1.5 turns, and they may become shorter
  if (by_count()) shortest = COPROCESSOR->TURN_LIMIT / 2;
  if (judgement->numeric) {
    const int64_t frequency = coprocessor_frequency();
    const uint64_t speed = (uint64_t)(frequency < 0 ? -frequency : frequency);
    shortest = speed != 0 ? (UINT64_C(1) << 47) / speed : UINT32_MAX;
  }
  return shortest < 1 ? 1 : shortest < UINT32_MAX ? (uint32_t)shortest : UINT32_MAX;
}

bool judgement_until(struct judgement* judgement, uint32_t count) {
  const uint32_t most = stride(judgement);
  for (uint32_t now = sampling_count(); now < count; now = sampling_count()) {
    if (!sampling_wait(count - now < most ? count : now + most)) return false;
    judgement_look(judgement);
  }
  return true;
}

bool judgement_wait(struct judgement* judgement, uint32_t most) {
  const uint32_t before = judgement->judged, begin = sampling_count();
  for (judgement_look(judgement); judgement->judged == before; judgement_look(judgement)) {
    const uint32_t now = sampling_count();
    if (now - begin >= most) return true;
    if (!sampling_wait(now + 1)) return false;
  }
  return true;
}

// The last sample again, with the reference where it was for it, ends the window.
void judgement_finish(struct judgement* judgement) {
  while ((COPROCESSOR->STATUS & COPROCESSOR_STATUS_BUSY_Msk) != 0) continue;
  judgement_look(judgement);
  if (sampling_count() == 0) return;
  COPROCESSOR->CTRL &=
      ~(COPROCESSOR_CTRL_DEMOD_Msk | COPROCESSOR_CTRL_ADC_Msk | COPROCESSOR_CTRL_IE_RESULT_Msk);
  coprocessor_set_phase((coprocessor_phase() - (uint64_t)coprocessor_frequency()) &
                        ((UINT64_C(1) << 48) - 1));
  COPROCESSOR->TURN_LIMIT = 1;
  judgement->cut = true;
  coprocessor_submit(COPROCESSOR->RAW_U, COPROCESSOR->RAW_V);
  while ((COPROCESSOR->STATUS & COPROCESSOR_STATUS_BUSY_Msk) != 0) continue;
  judgement_look(judgement);
}

// The whole turns that a pass needs beyond what is covered.
static uint32_t needed_before(const struct judgement* judgement) {
  return judgement->fewest > judgement->whole ? judgement->fewest - judgement->whole : 0;
}

static struct turn_evidence worst_of_all(const struct judgement* judgement) {
  struct turn_evidence worst = judgement->worst;
  for (uint32_t i = 0; i < needed_before(judgement); ++i) keep_worst(&worst, &judgement->turns[i]);
  return worst;
}

uint32_t judgement_covered(const struct judgement* judgement) {
  uint32_t samples = judgement->samples - 1;  // except the one that ended the last window
  for (uint32_t i = 0; i < needed_before(judgement); ++i) samples += judgement->turns[i].samples;
  return samples;
}

uint32_t judgement_motion(const struct judgement* judgement) {
  if (by_count()) return 0;
  if (judgement->numeric) {
    const int64_t frequency = coprocessor_frequency();
    return capped((uint64_t)((frequency < 0 ? -frequency : frequency) + 65535) >> 16);
  }
  const double step = judgement->evenness.mean_step;
  return capped((uint64_t)(step < 0 ? -step : step));
}

static uint64_t radius_and_residue(const struct judgement* judgement,
                                   const struct turn_evidence* turn) {
  const uint64_t by_radius = (judgement->numeric ? 2 : 4) * (uint64_t)turn->radius;
  const uint64_t by_residue = 2 * (uint64_t)turn->residue;
  const bool by_residue_alone = judgement->corrected && judgement->numeric;
  return by_radius > by_residue && !by_residue_alone ? by_radius : by_residue;
}

// A sample that is stale is off by its jump, and by what the sensor is off, which is seldom more
// than half of what the evidence allows.
static uint64_t with_jump(uint64_t error, uint64_t jump) {
  const uint64_t both = error - error / 4 + jump;
  return both > error ? both : error;
}

static bool assumes_harmonics(const struct judgement* judgement) {
  if (judgement->unseen == 0 || judgement->numeric) return false;
  return !judgement->watches ||
         2 * (uint64_t)evenness_deviation(&judgement->evenness) > judgement->unseen;
}

// Harmonics along the circle do not leave it. A steady shaft shows them; of an unsteady one what
// repeats from turn to turn is the sensor's.
uint64_t judgement_with_harmonics(const struct judgement* judgement, uint64_t error) {
  if (!judgement->watches) return error + judgement->unseen;
  const bool assumed = assumes_harmonics(judgement);
  const uint64_t seen = 2 * (uint64_t)(assumed ? evenness_repeating(&judgement->evenness)
                                               : evenness_deviation(&judgement->evenness));
  const uint64_t allowed = error + (assumed ? judgement->unseen : 0);
  return seen > allowed ? seen : allowed;
}

uint32_t judgement_bound(const struct judgement* judgement) {
  if (judgement->before < needed_before(judgement)) return HALF_TURN;
  const struct turn_evidence worst = worst_of_all(judgement);
  const uint64_t error = judgement_with_harmonics(judgement, radius_and_residue(judgement, &worst));
  return capped(with_jump(error, worst.jump) + worst.drift + wander(judgement));
}

uint32_t judgement_bound_of_last(const struct judgement* judgement) {
  if (judgement->spoilt != NULL) return HALF_TURN;
  const struct turn_evidence* const turn = &judgement->last;
  return capped(with_jump(radius_and_residue(judgement, turn), turn->jump) + turn->drift);
}

// What phi has gone if it always continued as in the last turns: the least of them, one way.
static uint64_t steady_slip(const struct judgement* judgement) {
  uint32_t least = HALF_TURN;
  for (uint32_t i = 0; i < learning_judged; ++i) {
    const int32_t way = judgement->phi_way[i];
    if ((way < 0) != (judgement->phi_way[0] < 0)) return 0;
    if (magnitude(way) < least) least = magnitude(way);
  }
  return (uint64_t)least * judgement->judged;
}

// Whether phi went further than a loop that settles would take it.
static bool phi_slips(const struct judgement* judgement, uint64_t bound) {
  const uint64_t slip = (uint64_t)(judgement->slip < 0 ? -judgement->slip : judgement->slip);
  return slip > bound / 8 + ROUNDINGS || steady_slip(judgement) > bound / 3 + ROUNDINGS;
}

uint32_t judgement_conditions(const struct judgement* judgement, uint64_t bound) {
  const bool measured = !judgement->numeric || judgement->steering != NULL;
  const bool slips = !measured && phi_slips(judgement, bound);
  const uint64_t drift = judgement->any_motion ? judgement->wandered : steady_drift(judgement);
  uint32_t conditions = 0;
  if (measured || slips) conditions |= verdict_if_no_sample_is_stale;
  if (by_count() || judgement->any_motion) conditions |= verdict_if_every_sample_is_the_sensors;
  if (slips || drift > bound / 8 + ROUNDINGS) conditions |= verdict_if_no_second_signal;
  if (assumes_harmonics(judgement)) conditions |= verdict_if_harmonics_are_small;
  return conditions;
}

const char* judgement_objection(const struct judgement* judgement) {
  static const char too_short[] = "the signal ended before enough whole turns were seen";
  if (judgement->judged == 0) return too_short;
  if (judgement->objection != NULL) return judgement->objection;
  if (judgement->before < needed_before(judgement)) {
    if (judgement->spoilt != NULL) return judgement->spoilt;
    return too_short;
  }
  const uint32_t status = COPROCESSOR->STATUS;
  if ((status & COPROCESSOR_STATUS_ALARM_Msk) != 0) return "the signals have left their circle";
  if ((status & COPROCESSOR_STATUS_VALID_Msk) == 0) return "the last sample has no valid angle";
  if (judgement_bound(judgement) > judgement->limit)
    return "the evidence allows an angle error above limit_deg";
  return NULL;
}
