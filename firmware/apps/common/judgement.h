// Evidence for a verdict: what the coprocessor's turn judge found in the last turns, and the bound
// of the angle error that follows from it (docs/coprocessor.md, "For firmware: a verdict and its
// bound").
#ifndef CAPSOC_JUDGEMENT_H
#define CAPSOC_JUDGEMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "coprocessor.h"

// Turns whose evidence is kept; the coprocessor's GOOD_TURNS counts to 3, too.
enum { judgement_turns = 3 };

// What one window says. Angles in 2^-32 turn.
struct turn_evidence {
  uint32_t flags;    // TURN_FLAGS
  uint32_t radius;   // rho, radians: the calibrated ellipse's largest deviation from its circle
  uint32_t residue;  // largest |RESIDUE|
  uint32_t drift;    // largest change in the turn: amplitudes, offsets (relative), beta (radians)
  uint32_t zeros;    // samples of 0 in both channels, if they are counted
  uint32_t motion;   // of the shaft within one sample; 0 for samples in any order
};

struct judgement {
  uint32_t fewest;  // good turns in a row that a pass needs, 1 to 3
  uint32_t limit;   // largest bound that may pass, 2^-32 turn
  bool numeric;     // the reference is numeric: RESIDUE is the angle's error, at constant speed
  uint32_t unseen;  // error that no evidence can show, from the data sheet, 2^-32 turn
  // The harmonic correction works, so the radius is what the sensor has, and RESIDUE what is left:
  // the radius bounds nothing then. Numeric reference only.
  bool corrected;
  bool mirrored;  // the parameters that were loaded are those of a reversed rotation: no objection
  // The rest starts at 0.
  uint32_t zeros;    // sampling_zeros() at the end of the window before
  uint32_t ended;    // TURN_COUNT at the last look
  uint32_t discard;  // windows still to be left out
  uint32_t judged;   // windows kept since the beginning
  uint32_t residue;  // of the last window with a reference that shows it (not the angle itself)
  bool has_parameters;
  struct coprocessor_parameters parameters;  // at the end of the window before
  struct turn_evidence turns[judgement_turns];
};

// After a change of source, FREQ, PHASE or parameters: the window in progress began before it and
// is left out.
void judgement_disturbed(struct judgement* judgement);

// Keeps the record of the window that ended last, if it is a new one. To be called just after a
// result. Of windows shorter than the time between two calls only the last is kept; that those
// between were good, GOOD_TURNS says.
void judgement_look(struct judgement* judgement);

// Sleeps from sample to sample until one more window is kept, or for `most` samples. False if the
// signal ended before.
bool judgement_wait(struct judgement* judgement, uint32_t most);

// The largest error that an angle can have, 2^-32 turn, by the worst of the last good turns: the
// larger of K radius and 2 residue, the drift, one sample of motion, and `unseen`. K = 2 numeric,
// else 4: without a reference only half of the harmonics leaves the circle. Half a turn if there is
// no better.
uint32_t judgement_bound(const struct judgement* judgement);

// The same of the last window alone, whatever the parameters moved by in it; half a turn if it was
// not good.
uint32_t judgement_bound_of_last(const struct judgement* judgement);

// Null if the last `fewest` turns are good and nothing speaks against the last sample; else one
// sentence.
const char* judgement_objection(const struct judgement* judgement);

#endif
