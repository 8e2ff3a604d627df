// Clock controller: the frequency of HCLK and PCLK, which are one clock.
#ifndef CAPSOC_CLOCK_H
#define CAPSOC_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

bool clock_present(void);
// Hz. Without a clock controller: the 25 MHz of the board.
uint32_t clock_frequency_hz(void);
// Runs HCLK from the PLL at 25 MHz * multiplier / divider (1 to 200 MHz). False, with the reference
// clock selected, if the controller refuses the ratio or does not lock. What was derived from the
// old frequency (baud rate, sampling period) is for the caller to set again.
bool clock_use_pll(uint32_t multiplier, uint32_t divider);
// Back to the 25 MHz reference.
void clock_use_reference(void);

#endif
