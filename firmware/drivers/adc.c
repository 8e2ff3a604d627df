#include "adc.h"

#include "an385.h"
#include "bus_probe.h"
#include "capsoc_device.h"

enum { adc_id = 0x43414443 };

bool adc_present(void) {
  uint32_t id = 0;
  return bus_probe(ADC_BASE, &id) && id == adc_id;
}

static bool accepted(void) {
  const bool refused = (ADC->FLAGS & ADC_FLAGS_CONFIG_Msk) != 0;
  if (refused) ADC->FLAGS = ADC_FLAGS_CONFIG_Msk;
  return !refused;
}

bool adc_set_period(uint32_t cycles) {
  ADC->FLAGS = ADC_FLAGS_CONFIG_Msk;
  ADC->PERIOD = cycles;
  return accepted();
}

bool adc_set_bits(uint32_t bits) {
  ADC->FLAGS = ADC_FLAGS_CONFIG_Msk;
  ADC->BITS = bits;
  return accepted();
}

void adc_start(uint32_t interrupts) {
  ADC->FLAGS = ADC_FLAGS_SAMPLE_Msk | ADC_FLAGS_CLIP_U_Msk | ADC_FLAGS_CLIP_V_Msk |
               ADC_FLAGS_END_Msk | ADC_FLAGS_CONFIG_Msk;
  ADC->CTRL = ADC_CTRL_RUN_Msk | interrupts;
}

void adc_stop(void) {
  ADC->CTRL = 0;
}

bool adc_ended(void) {
  return (ADC->STATUS & ADC_STATUS_ENDED_Msk) != 0;
}
