// Keeps a numeric reference at the angle of a shaft whose speed was measured. At the end of every
// turn the speed is corrected by a part of the residue and of its change. It is not corrected if
// the largest residue of the turn is within a third of that of the best turn. The speed settles in
// about five turns and follows slower changes. Errors of the sensor within a turn do not change it.
#ifndef CAPSOC_STEERING_H
#define CAPSOC_STEERING_H

#include <stdbool.h>
#include <stdint.h>

struct steering {
  bool any;        // a turn has ended; the rest starts at 0
  int32_t before;  // residue at its end, 2^-32 turn
  uint32_t least;  // of the largest residues of the turns so far
};

// Call after the last result of a turn. `samples`: of the turn; `largest`: its RESIDUE_MAX.
void steering_end_turn(struct steering* state, uint32_t samples, uint32_t largest);

#endif
