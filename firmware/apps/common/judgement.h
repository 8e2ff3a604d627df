// Evidence for a verdict: what the coprocessor's turn judge found in each window, and the bound of
// the angle error that follows from it (docs/reference/coprocessor.md, "For firmware: a verdict and
// its bound"). A bound is about the samples that are *covered*: from judgement_cover to
// judgement_finish without a gap, and the whole turns before that a pass needs in addition.
#ifndef CAPSOC_JUDGEMENT_H
#define CAPSOC_JUDGEMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "coprocessor.h"
#include "evenness.h"
#include "signal_shape.h"
#include "steering.h"

// Windows before the covered ones whose evidence is kept; `fewest` is at most one more.
enum { judgement_turns = 3 };
// Turns of demodulation whose changes are kept, and how many of them a bound looks at. A second
// signal at up to 1.3 times the speed still shows in the sum of three; a faster one shows in a
// turn. More turns tell a slow drift from noise.
enum { learning_kept = 8, learning_judged = 3 };

// What one window says. Angles in 2^-32 turn.
struct turn_evidence {
  uint32_t flags;    // TURN_FLAGS
  uint32_t samples;  // TURN_SAMPLES
  uint32_t radius;   // rho, radians: the calibrated ellipse's largest deviation from its circle
  uint32_t residue;  // largest |RESIDUE|
  uint32_t drift;    // largest change in the turn: amplitudes, offsets (relative), beta (radians)
  uint32_t zeros;    // samples of 0 in both channels, if they are counted
  uint32_t repeats;  // samples identical to the previous one, if they are counted
  // Largest step of the angle beyond the mean step, if the angles are watched. If the shaft may
  // have any motion: beyond twice the mean length of all steps.
  uint32_t jump;
  bool whole;  // a turn, or a full window in any order; not cut short at either end
};

struct judgement {
  uint32_t fewest;  // whole good turns that a pass needs, 1 to judgement_turns
  uint32_t limit;   // largest bound that may pass, 2^-32 turn
  bool numeric;     // the reference is numeric: RESIDUE is the angle's error, at constant speed
  uint32_t unseen;  // error that no evidence can show, from the data sheet, 2^-32 turn
  // The harmonic correction works, so the radius is what the sensor has, and RESIDUE what is left:
  // the radius bounds nothing then. Numeric reference only.
  bool corrected;
  // Keeps the numeric reference at the angle; null: its speed is a setting.
  struct steering* steering;
  uint32_t idle_turns;  // without learning, between two turns with it; the least
  bool shuffled;        // samples in random order: one identical to the previous one is stale
  bool mirrored;  // the parameters that were loaded are those of a reversed rotation: no objection
  // The shaft may rest, turn back and change its speed: what says so is no objection. Nothing is
  // covered; the caller looks at every window.
  bool any_motion;
  // The samples come in order of time and there is no numeric reference: every angle is watched.
  bool watches;
  // The rest starts at 0.
  bool covers;       // judgement_cover was called
  bool cut;          // the window under way began or ends elsewhere than a turn does
  uint32_t zeros;    // sampling_zeros() at the end of the window before
  uint32_t repeats;  // sampling_repeats(), likewise
  uint32_t ended;    // TURN_COUNT at the last look
  uint32_t discard;  // windows still to be left out
  uint32_t judged;   // whole windows kept since the beginning
  uint32_t watched;  // sample whose angle was watched last
  // Of the last turns of demodulation, the last one first
  uint32_t learning[learning_kept];                     // drifts
  struct coprocessor_parameters change[learning_kept];  // what was added in each, wrapped
  uint32_t learning_turns;
  struct coprocessor_parameters settled;  // those from which `wandered` counts; the caller's
  uint32_t wandered;                      // how far the parameters were from them at most
  // Numeric reference, good turns of demodulation: how far phi goes that does not settle
  uint32_t phi_turns;
  uint32_t phi;                      // at the end of the last, 2^-32 turn
  uint32_t phi_change;               // in a turn, decaying
  int32_t phi_way[learning_judged];  // in the last turns, the last one first
  int64_t slip;                      // since the fourth
  bool has_parameters;
  struct coprocessor_parameters parameters;     // at the end of the window before
  struct turn_evidence turns[judgement_turns];  // whole ones before what is covered, the last first
  uint32_t before;            // of them that are good, without a gap up to what is covered
  const char* spoilt;         // what contradicts the window before what is covered; null: nothing
  struct turn_evidence last;  // of that window
  // Of what is covered
  uint32_t samples;            // judged
  uint32_t whole;              // whole windows
  struct turn_evidence worst;  // the largest of each
  const char* objection;       // the first; null: none
  struct evenness evenness;
  struct signal_shape shape;  // raw samples of the whole run, some of them
};

// The window in progress is no turn: what ends one has changed (the source, FREQ, PHASE). What it
// shows still counts.
void judgement_disturbed(struct judgement* judgement);

// Everything so far is of another setting, for instance another direction: it is forgotten, and the
// window in progress is left out.
void judgement_restart(struct judgement* judgement);

// From the next sample on a pass is about every angle. Before it, the last turns may be needed,
// too.
void judgement_cover(struct judgement* judgement);

// Keeps the record of the window that ended last, if it is a new one. To be called just after a
// result. What is covered has a gap if more than one window ended since the last call.
void judgement_look(struct judgement* judgement);

// Sleeps until the coprocessor has `count` results, looking often enough that no window is missed.
// False if the signal ended before.
bool judgement_until(struct judgement* judgement, uint32_t count);

// Sleeps until one more whole window is kept, or for `most` samples. False if the signal ended
// before.
bool judgement_wait(struct judgement* judgement, uint32_t most);

// After the last sample, with the ADC stopped: ends the window under way, so that it is judged to
// its last sample. Nothing is learnt and no other result is read afterwards.
void judgement_finish(struct judgement* judgement);

// The largest error that an angle at its sampling instant can have, 2^-32 turn, over all that is
// covered. Half a turn if there is no better.
uint32_t judgement_bound(const struct judgement* judgement);
// What a pass with this bound takes for granted, enum program_verdict_condition:
// - no sample is stale: of a numeric reference jumps are seen, but samples that come later and
// later
//   are the same as a speed that is a little off, and phi follows them; about a third of the bound
//   is too far. A delay that was always the same is nobody's to see.
// - every sample is the sensor's: of samples in any order, or of any motion, one that lies on the
//   circle in a wrong place shows nothing.
// - no second signal at almost the same speed: the parameters drift on by an eighth of the bound
//   or more, or phi slips, and a drift of the sensor looks the same.
// - harmonics along the circle stay below `unseen`: the motion does not show them.
uint32_t judgement_conditions(const struct judgement* judgement, uint64_t bound);
// Samples that the bound is about.
uint32_t judgement_covered(const struct judgement* judgement);
// Of the shaft from one sample to the next, 2^-32 turn, mean of the last whole turn; 0 for samples
// in any order.
uint32_t judgement_motion(const struct judgement* judgement);

// The bound by the window that ended last alone, before anything is covered, without harmonics
// along the circle; half a turn if something contradicts it.
uint32_t judgement_bound_of_last(const struct judgement* judgement);

// What it is with them: `error` and the larger of what the motion shows and what is assumed.
uint64_t judgement_with_harmonics(const struct judgement* judgement, uint64_t error);

// Null if nothing contradicts what is covered; else one sentence, the plainest cause.
const char* judgement_objection(const struct judgement* judgement);

#endif
