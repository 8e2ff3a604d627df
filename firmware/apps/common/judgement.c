#include "judgement.h"

#include <stddef.h>

#include "capsoc_device.h"
#include "sampling.h"

// 2^32 / 2 pi: a radian in 2^-32 turn.
#define RADIAN UINT64_C(683565276)
// Limits of the drift in a turn (0.05, as relative change or radians) and of nothing else: those of
// the radius, the winding and the rest are the coprocessor's.
#define DRIFT_LIMIT (RADIAN / 20)
// Fewer samples of 0 in both channels may be the place where the circle crosses 0.
#define ZEROS_LIMIT 3
#define HALF_TURN (UINT32_C(1) << 31)

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

// A late or a doubled sample does not leave the circle: it is off by as much as the shaft turns
// meanwhile.
static uint32_t motion_in_window(void) {
  const uint32_t samples = COPROCESSOR->TURN_SAMPLES;
  if (samples == 0 || (COPROCESSOR->JUDGE & COPROCESSOR_JUDGE_COUNT_Msk) != 0) return 0;
  return capped(((uint64_t)magnitude(COPROCESSOR->WINDING) * 4 + samples - 1) / samples);
}

void judgement_disturbed(struct judgement* judgement) {
  judgement->discard = 1;
}

void judgement_look(struct judgement* judgement) {
  const uint32_t flags = COPROCESSOR->TURN_FLAGS;
  const uint32_t ended =
      field(flags, COPROCESSOR_TURN_FLAGS_TURN_COUNT_Msk, COPROCESSOR_TURN_FLAGS_TURN_COUNT_Pos);
  const uint32_t fresh = (ended - judgement->ended) & 0xFF;
  if (fresh == 0) return;
  judgement->ended = ended;
  const struct coprocessor_parameters parameters = coprocessor_read_parameters();
  const struct turn_evidence turn = {
      .flags = flags,
      .radius = ratio(COPROCESSOR->RADIUS_MAX, magnitude(COPROCESSOR->TURN_DET)),
      .residue = COPROCESSOR->RESIDUE_MAX,
      .drift = judgement->has_parameters ? drift_between(&judgement->parameters, &parameters)
                                         : HALF_TURN,
      .zeros = sampling_zeros() - judgement->zeros,
      .motion = motion_in_window(),
  };
  judgement->zeros += turn.zeros;
  judgement->parameters = parameters;
  judgement->has_parameters = true;
  const uint32_t discard = judgement->discard;
  judgement->discard = 0;
  if (fresh <= discard) return;
  if (turn.residue != 0) judgement->residue = turn.residue;
  judgement->turns[judgement->judged % judgement_turns] = turn;
  ++judgement->judged;
}

// The coprocessor's word, or nothing against the turn but that it was mirrored as expected.
static bool good(const struct judgement* judgement, uint32_t flags, bool counts) {
  if ((flags & COPROCESSOR_TURN_FLAGS_GOOD_Msk) != 0) return true;
  if (!judgement->mirrored || (flags & COPROCESSOR_TURN_FLAGS_MIRROR_Msk) == 0) return false;
  const uint32_t winding = counts ? 0 : COPROCESSOR_TURN_FLAGS_WINDING_Msk;
  const uint32_t bad = COPROCESSOR_TURN_FLAGS_CLIPPED_Msk | COPROCESSOR_TURN_FLAGS_SAT_Msk |
                       COPROCESSOR_TURN_FLAGS_NOANGLE_Msk | COPROCESSOR_TURN_FLAGS_RADIUS_Msk |
                       COPROCESSOR_TURN_FLAGS_TIMEOUT_Msk | winding;
  const uint32_t octants = COPROCESSOR_TURN_FLAGS_OCTANTS_Msk;
  return (flags & bad) == 0 && (flags & octants) == octants;
}

// The plainest cause first: what makes the others. What is good may have a winding that does not
// count (JUDGE.COUNT).
static const char* objection_to(const struct judgement* judgement,
                                const struct turn_evidence* turn) {
  static const struct {
    uint32_t flag;
    const char* sentence;
  } causes[] = {
      {COPROCESSOR_TURN_FLAGS_CLIPPED_Msk,
       "the ADC clipped samples of the last turns: reduce the gain"},
      {COPROCESSOR_TURN_FLAGS_SAT_Msk, "a value in the coprocessor saturated in the last turns"},
      {COPROCESSOR_TURN_FLAGS_NOANGLE_Msk,
       "the signals give no angle: look for a dead or constant channel"},
      {COPROCESSOR_TURN_FLAGS_RADIUS_Msk,
       "the calibrated signals do not stay on a circle: noise, harmonics or a broken channel"},
      {COPROCESSOR_TURN_FLAGS_TIMEOUT_Msk,
       "no whole turn was seen in time: the shaft rests or is too slow"},
      {COPROCESSOR_TURN_FLAGS_WINDING_Msk,
       "the angle does not go round once a turn: is the speed right?"},
      {COPROCESSOR_TURN_FLAGS_MIRROR_Msk, "the rotation is the other way round"},
  };
  const bool counts = (COPROCESSOR->JUDGE & COPROCESSOR_JUDGE_COUNT_Msk) != 0;
  if (!good(judgement, turn->flags, counts)) {
    const uint32_t flags = counts ? turn->flags & ~COPROCESSOR_TURN_FLAGS_WINDING_Msk : turn->flags;
    for (size_t i = 0; i < sizeof causes / sizeof causes[0]; ++i)
      if ((flags & causes[i].flag) != 0) return causes[i].sentence;
    return "parts of the turn had no samples: the shaft rests or swings";
  }
  if (turn->zeros >= ZEROS_LIMIT)
    return "samples are 0 in both channels again and again: the converter drops out";
  if (turn->drift >= DRIFT_LIMIT) return "the parameters still drift by 5 % a turn or more";
  return NULL;
}

// The window that ended `back` windows ago, 0: the last; null if it is not kept.
static const struct turn_evidence* turn_before(const struct judgement* judgement, uint32_t back) {
  if (back >= judgement_turns || back >= judgement->judged) return NULL;
  return &judgement->turns[(judgement->judged - 1 - back) % judgement_turns];
}

static uint64_t bound_of(const struct judgement* judgement, const struct turn_evidence* turn) {
  const uint64_t by_radius = (judgement->numeric ? 2 : 4) * (uint64_t)turn->radius;
  const uint64_t by_residue = 2 * (uint64_t)larger(turn->residue, judgement->residue);
  const bool by_residue_alone = judgement->corrected && judgement->numeric;
  const uint64_t error = by_radius > by_residue && !by_residue_alone ? by_radius : by_residue;
  return error + turn->drift + turn->motion + judgement->unseen;
}

uint32_t judgement_bound_of_last(const struct judgement* judgement) {
  const struct turn_evidence* const turn = turn_before(judgement, 0);
  if (turn == NULL || (turn->flags & COPROCESSOR_TURN_FLAGS_GOOD_Msk) == 0) return HALF_TURN;
  return capped(bound_of(judgement, turn));
}

uint32_t judgement_bound(const struct judgement* judgement) {
  uint64_t worst = 0;
  uint32_t good_turns = 0;
  for (;; ++good_turns) {
    const struct turn_evidence* const turn = turn_before(judgement, good_turns);
    if (turn == NULL || objection_to(judgement, turn) != NULL) break;
    const uint64_t total = bound_of(judgement, turn);
    if (total > worst) worst = total;
  }
  return good_turns == 0 ? HALF_TURN : capped(worst);
}

const char* judgement_objection(const struct judgement* judgement) {
  for (uint32_t back = 0; back < judgement->fewest; ++back) {
    const struct turn_evidence* const turn = turn_before(judgement, back);
    if (turn == NULL) return "the signal ended before enough whole turns were seen";
    const char* const objection = objection_to(judgement, turn);
    if (objection != NULL) return objection;
  }
  const uint32_t status = COPROCESSOR->STATUS;
  if ((status & COPROCESSOR_STATUS_ALARM_Msk) != 0) return "the signals have left their circle";
  // It counts no mirrored turn.
  if (!judgement->mirrored && field(status, COPROCESSOR_STATUS_GOOD_TURNS_Msk,
                                    COPROCESSOR_STATUS_GOOD_TURNS_Pos) < judgement->fewest)
    return "a turn shortly before the end was not good";
  if ((status & COPROCESSOR_STATUS_VALID_Msk) == 0) return "the last sample has no valid angle";
  if (judgement_bound(judgement) > judgement->limit)
    return "the evidence allows an angle error above limit_deg";
  return NULL;
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
