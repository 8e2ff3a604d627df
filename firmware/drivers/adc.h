// ADC front-end: the sample clock and the two channels of the sensor.
#ifndef CAPSOC_ADC_H
#define CAPSOC_ADC_H

#include <stdbool.h>
#include <stdint.h>

bool adc_present(void);
// Sampling period in PCLK cycles, 32 at least. False if the front-end refuses it.
bool adc_set_period(uint32_t cycles);
// Resolution, 12 to 32 bits. False if the front-end refuses it.
bool adc_set_bits(uint32_t bits);
// Starts with cleared flags; sample 0 is taken one period later. `interrupts`: ADC_CTRL_IE_..._Msk.
void adc_start(uint32_t interrupts);
void adc_stop(void);
// The signal has ended (a recording that is over).
bool adc_ended(void);

#endif
