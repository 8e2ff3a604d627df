#include "sampling.h"

#include "adc.h"
#include "an385.h"
#include "capsoc_device.h"
#include "clock.h"
#include "sleep.h"

static volatile uint32_t results;
static volatile uint32_t samples;  // while listening
static volatile uint32_t events;   // moves with each of them and at the end of the signal
static volatile int32_t sample_u, sample_v;
static volatile bool ended;
static volatile uint32_t zeros;
static volatile uint32_t repeats;
static bool counts_oddities;
// Every 397th sample: a prime, so that they are no few places of the turn.
enum { probe_period = 397, probes_most = 16 };
static volatile struct sampling_probe probes[probes_most];
static volatile uint32_t probes_kept;
static uint32_t probes_taken;
static uint32_t until_probe = 1;

static void count_oddities(void) {
  static int32_t u_before, v_before;
  const int32_t u = COPROCESSOR->RAW_U, v = COPROCESSOR->RAW_V;
  if (u == 0 && v == 0) ++zeros;
  if (results != 0 && u == u_before && v == v_before) ++repeats;
  u_before = u;
  v_before = v;
}

static void keep_probe(void) {
  until_probe = probe_period;
  probes[probes_kept % probes_most] =
      (struct sampling_probe){.u = COPROCESSOR->RAW_U, .v = COPROCESSOR->RAW_V};
  ++probes_kept;
}

// Runs once a sample, 100,000 times in a calibration: makes one bus access where no option needs
// more.
void COPROCESSOR_Handler(void) {
  COPROCESSOR->FLAGS = COPROCESSOR_FLAGS_RESULT_Msk;
  if (counts_oddities) count_oddities();
  if (--until_probe == 0) keep_probe();
  ++results;
  ++events;
  __DSB();  // the line is down before the return looks at it
}

void ADC_Handler(void) {
  const uint32_t flags = ADC->FLAGS;
  ADC->FLAGS = flags;
  if ((flags & ADC_FLAGS_SAMPLE_Msk) != 0) {
    sample_u = ADC->DATA_U;
    sample_v = ADC->DATA_V;
    ++samples;
  }
  if ((flags & ADC_FLAGS_END_Msk) != 0) ended = true;
  ++events;
  __DSB();
}

bool sampling_start(uint32_t rate_hz) {
  results = 0;
  ended = false;
  if (!adc_set_period(clock_frequency_hz() / rate_hz)) return false;
  NVIC_EnableIRQ(COPROCESSOR_IRQn);
  NVIC_EnableIRQ(ADC_IRQn);
  adc_start(ADC_CTRL_IE_END_Msk);
  return true;
}

void sampling_stop(void) {
  adc_stop();
  NVIC_DisableIRQ(ADC_IRQn);
  NVIC_DisableIRQ(COPROCESSOR_IRQn);
}

void sampling_count_oddities(void) {
  counts_oddities = true;
}

uint32_t sampling_zeros(void) {
  return zeros;
}

uint32_t sampling_repeats(void) {
  return repeats;
}

bool sampling_take_probe(struct sampling_probe* probe) {
  if (probes_kept - probes_taken > probes_most) probes_taken = probes_kept - probes_most;
  if (probes_taken == probes_kept) return false;
  *probe = probes[probes_taken++ % probes_most];
  return true;
}

uint32_t sampling_count(void) {
  return results;
}

bool sampling_wait(uint32_t count) {
  for (;;) {
    const uint32_t seen = events;  // before the tests: what comes after them is not slept through
    if (results >= count) return true;
    if (ended) return false;
    sleep_while_equal(&events, seen);
  }
}

void sampling_listen(bool on) {
  // RUN is written as it is: a signal that has ended is not started again.
  const uint32_t others = ADC->CTRL & ~ADC_CTRL_IE_SAMPLE_Msk;
  ADC->FLAGS = ADC_FLAGS_SAMPLE_Msk;
  ADC->CTRL = on ? others | ADC_CTRL_IE_SAMPLE_Msk : others;
}

bool sampling_next(int32_t* u, int32_t* v) {
  const uint32_t before = samples;
  while (samples == before) {
    const uint32_t seen = events;
    if (samples != before) break;
    if (ended) return false;
    sleep_while_equal(&events, seen);
  }
  *u = sample_u;
  *v = sample_v;
  return true;
}
