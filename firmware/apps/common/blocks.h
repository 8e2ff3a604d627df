// Block learning (docs/reference/coprocessor.md) as the programs use it.
#ifndef CAPSOC_BLOCKS_H
#define CAPSOC_BLOCKS_H

#include <stdbool.h>
#include <stdint.h>

// CTRL.BLOCK is there. Writes CTRL.
bool blocks_present(void);

// Sets the steps that solve the normal equations of a turn of N = `turn` samples: 2 / N for sine
// and cosine, 1 / N for the constant. With the angle as its own reference they find the whole error
// across the circle and half of the error along it. A `gain` of 2 finds the whole error along the
// circle and twice the error across it. So the caller alternates the gains.
void blocks_set_steps(uint32_t turn, uint32_t gain);

// Sets the watchdog that ends the window of a shaft at rest: one and a half turns.
void blocks_watch(uint32_t turn);

// Waits for the first turn, for at most `most` samples, and loads coefficients from its range.
// Returns the samples of that turn; 0 if the signal ended or no turn was seen.
uint32_t blocks_measure_turn(uint32_t most);

#endif
