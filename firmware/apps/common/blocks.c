#include "blocks.h"

#include "capsoc_device.h"
#include "coprocessor.h"
#include "sampling.h"
#include "start_range.h"

bool blocks_present(void) {
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_BLOCK_Msk;
  return (COPROCESSOR->CTRL & COPROCESSOR_CTRL_BLOCK_Msk) != 0;
}

void blocks_set_steps(uint32_t turn, uint32_t gain) {
  const uint32_t step = (uint32_t)((gain * (UINT64_C(1) << 32) + turn / 2) / turn);
  coprocessor_set_steps(step);
  COPROCESSOR->STEP_CU = step / 2;
  COPROCESSOR->STEP_CV = step / 2;
}

void blocks_watch(uint32_t turn) {
  COPROCESSOR->TURN_LIMIT = turn + turn / 2 + 1;
}

uint32_t blocks_measure_turn(uint32_t most) {
  struct start_range range = {0};
  sampling_listen(true);
  while (range.turn == 0 && range.samples < most) {
    int32_t u = 0, v = 0;
    if (!sampling_next(&u, &v)) return 0;
    start_range_feed(&range, u, v);
  }
  sampling_listen(false);
  if (range.turn != 0) start_range_load_with_phase(&range);
  return range.turn;
}
