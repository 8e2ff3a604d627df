// Block learning (docs/reference/coprocessor.md) as the programs use it.
#ifndef CAPSOC_BLOCKS_H
#define CAPSOC_BLOCKS_H

#include <stdbool.h>
#include <stdint.h>

// CTRL.BLOCK is there. Writes CTRL.
bool blocks_present(void);

// Steps that solve the normal equations of a turn of so many samples: 2 / N for sine and cosine,
// 1 / N for the constant. With the angle as its own reference they find what moves samples off
// their circle, and half of what moves them along it; `gain` 2 finds all of that and the other's
// double. So the gains take turns.
void blocks_set_steps(uint32_t turn, uint32_t gain);

// The watchdog of a shaft that rests: one and a half turns.
void blocks_watch(uint32_t turn);

// Listens for the first turn, for at most so many samples, and loads coefficients of its range.
// Samples of that turn; 0 if the signal ended or no turn was seen.
uint32_t blocks_measure_turn(uint32_t most);

#endif
