#include "steering.h"

#include "capsoc_device.h"
#include "coprocessor.h"

void steering_end_turn(struct steering* state, uint32_t samples, uint32_t largest) {
  const int32_t residue = COPROCESSOR->RESIDUE;
  if (!state->any || largest < state->least) state->least = largest;
  const int64_t change = state->any ? (int64_t)residue - state->before : 0;
  state->before = residue;
  state->any = true;
  if (samples == 0 || largest - largest / 4 < state->least) return;
  // A half of the change and a quarter of the rest: both poles of the loop have a magnitude of
  // 0.71.
  const int64_t way = (2 * change + residue) * (1 << 14) / (int64_t)samples;
  coprocessor_set_frequency(coprocessor_frequency() + way);
}
