// Runs the ADC into the coprocessor and sleeps from result to result.
#ifndef CAPSOC_SAMPLING_H
#define CAPSOC_SAMPLING_H

#include <stdbool.h>
#include <stdint.h>

#include "capsoc_device.h"

// What a program that calibrates sample by sample has in CTRL: samples of the ADC, angles, and an
// interrupt for each result.
#define SAMPLING_CTRL \
  (COPROCESSOR_CTRL_CALIB_Msk | COPROCESSOR_CTRL_ADC_Msk | COPROCESSOR_CTRL_IE_RESULT_Msk)

// Enables both interrupts, starts the ADC at `rate_hz` and counts results from 0. False if the ADC
// refuses the rate.
bool sampling_start(uint32_t rate_hz);

// From here on samples that are 0 in both channels, and samples that are bit for bit the one
// before, are counted, at two more accesses to the bus for each sample. A converter that drops out
// or holds gives such samples; they may lie on the sensor's circle, so that nothing else shows
// them.
void sampling_count_oddities(void);
// Those counted so far.
uint32_t sampling_zeros(void);
uint32_t sampling_repeats(void);

// A few raw samples, Q1.31, spread over the turns. False if there is none that was not taken yet.
struct sampling_probe {
  int32_t u, v;
};
bool sampling_take_probe(struct sampling_probe* probe);
void sampling_stop(void);
// Results of the coprocessor since sampling_start.
uint32_t sampling_count(void);
// Sleeps until `count` results are there. False if the signal ended before.
bool sampling_wait(uint32_t count);

// The ADC's own samples, for software that looks at them before the coprocessor does.
void sampling_listen(bool on);
// Sleeps until the next sample, Q1.31. False if the signal ended.
bool sampling_next(int32_t* u, int32_t* v);

#endif
