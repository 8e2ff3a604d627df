// Calibrates the sensors of all channels at once, by blocks of a turn
// (docs/reference/coprocessor.md, "Block learning", "Channels"). Their shafts turn at one known
// speed. A channel passes if its last two turns were good; unlike `selfcal` this program bounds no
// angle. One that does not is refused, and the others continue.
//
// Status: 0 every channel passes, 1 at least one is refused or the signal ends, 2 the ADC refuses
// the settings, 3 no coprocessor with several channels and block learning on this board.
#include <stdbool.h>
#include <stdint.h>

#include "adc.h"
#include "an385.h"
#include "capsoc_device.h"
#include "clock.h"
#include "common_settings.h"
#include "console.h"
#include "coprocessor.h"
#include "coprocessor_channels.h"
#include "fixed_print.h"
#include "parameter_report.h"
#include "program_settings.h"
#include "sleep.h"

#define SETTINGS(NUMBER, TEXT)                                                            \
  BAUD_SETTING(NUMBER)                                                                    \
  RATE_SETTING(NUMBER)                                                                    \
  NUMBER(int64_t, frequency_hz, 1, -10000, 10000, 0x1p48, "Hz", "speed of the shafts")    \
  NUMBER(uint32_t, sensors, 4, 2, 16, 1, "", "channels that the converter takes in turn") \
  NUMBER(uint32_t, turns, 5, 3, 1e6, 1, "", "of learning, before a channel can pass")
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { most_channels = 16, good_turns = 2, more_turns = 2 };
enum { status_refused = 2, status_no_channels = 3 };

struct channel {
  uint32_t turns;       // that have ended
  uint32_t good;        // of the last ones, without a break
  uint32_t turn_flags;  // of the last
  bool done, passed;
  struct coprocessor_parameters parameters;
};
static struct channel channels[most_channels];

static volatile uint32_t events;
static volatile bool ended;

// The flags are taken in thread mode, where a window may be open.
void COPROCESSOR_Handler(void) {
  NVIC_DisableIRQ(COPROCESSOR_IRQn);
  ++events;
  __DSB();
}

void ADC_Handler(void) {
  ADC->FLAGS = ADC_FLAGS_END_Msk;
  ended = true;
  ++events;
  __DSB();
}

// Samples of a turn.
static uint32_t turn_of(int64_t frequency) {
  const uint64_t speed = (uint64_t)(frequency < 0 ? -frequency : frequency);
  return (uint32_t)(((UINT64_C(1) << 48) + speed / 2) / speed);
}

// From coefficients of 0 the error is the sample itself: one turn gives all six of them. Steps of 2
// / N and 1 / N solve the normal equations of a turn of N samples.
static void prepare(int64_t frequency) {
  const uint32_t turn = turn_of(frequency);
  const uint32_t step = (uint32_t)(((UINT64_C(1) << 32) + turn / 2) / turn);
  coprocessor_reset();
  coprocessor_set_frequency(frequency);
  coprocessor_set_steps(step);
  COPROCESSOR->STEP_CU = step / 2;
  COPROCESSOR->STEP_CV = step / 2;
  for (int i = coefficient_a_u; i <= coefficient_c_v; ++i)
    coprocessor_set_coefficient((enum coprocessor_coefficient)i, 0);
  coprocessor_lock_by_turns();
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_CALIB_Msk | COPROCESSOR_CTRL_ADC_Msk |
                      COPROCESSOR_CTRL_DEMOD_Msk | COPROCESSOR_CTRL_BLOCK_Msk |
                      COPROCESSOR_CTRL_IE_TURN_Msk;
}

// Takes the turn that has ended. The window is open.
static void look(struct channel* channel) {
  COPROCESSOR->FLAGS = COPROCESSOR_FLAGS_TURN_Msk;
  channel->turn_flags = COPROCESSOR->TURN_FLAGS;
  ++channel->turns;
  if ((channel->turn_flags & COPROCESSOR_TURN_FLAGS_GOOD_Msk) == 0)
    channel->good = 0;
  else
    ++channel->good;
  channel->passed = channel->turns >= settings.turns && channel->good >= good_turns;
  channel->done = channel->passed || channel->turns >= settings.turns + more_turns;
  if (!channel->done) return;
  channel->parameters = coprocessor_read_parameters();
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_CALIB_Msk | COPROCESSOR_CTRL_ADC_Msk;
}

// Until every channel is done. False if the signal ended before.
static bool learn(void) {
  for (uint32_t left = settings.sensors; left > 0;) {
    const uint32_t seen = events;
    NVIC_EnableIRQ(COPROCESSOR_IRQn);
    sleep_while_equal(&events, seen);
    if (ended) return false;
    for (uint32_t pending = coprocessor_channels_pending(), i = 0; i < settings.sensors; ++i) {
      if ((pending >> i & 1) == 0) continue;
      coprocessor_channel_open(i);
      look(&channels[i]);
      coprocessor_channel_close();
      left -= channels[i].done ? 1 : 0;
    }
  }
  return true;
}

static const char* reason_of(uint32_t turn_flags) {
  if (turn_flags & COPROCESSOR_TURN_FLAGS_CLIPPED_Msk) return "samples were clipped";
  if (turn_flags & COPROCESSOR_TURN_FLAGS_NOANGLE_Msk) return "samples had no angle";
  if (turn_flags & COPROCESSOR_TURN_FLAGS_RADIUS_Msk) return "the signals are no ellipse";
  if (turn_flags & COPROCESSOR_TURN_FLAGS_MIRROR_Msk) return "the shaft turns the other way";
  if (turn_flags & COPROCESSOR_TURN_FLAGS_RESIDUE_Msk) return "the shaft has another speed";
  return "its turns were not good";
}

// The number of channels that were refused.
static uint32_t print_channels(void) {
  uint32_t refused = 0;
  for (uint32_t i = 0; i < settings.sensors; ++i) {
    print_text("channel ");
    print_unsigned(i, 0);
    if (channels[i].passed) {
      print_text(": pass: the last ");
      print_unsigned(good_turns, 0);
      print_text(" turns were good by the turn judge; no bound of the angle\n");
      print_parameter_table(&channels[i].parameters);
      continue;
    }
    ++refused;
    print_text(": refused, ");
    print_text(reason_of(channels[i].turn_flags));
    print_text("\n");
  }
  return refused;
}

int main(void) {
  const uint32_t clock_hz = clock_frequency_hz();
  console_open(clock_hz, settings.baud);
  if (!coprocessor_present() || !adc_present() || coprocessor_channel_count() < settings.sensors) {
    print_text("channels: no coprocessor with a channel for each sensor here\n");
    return status_no_channels;
  }
  print_text("channels: self-calibration of several sensors\n");
  // The converter takes one sensor after another.
  const uint32_t period = clock_hz / settings.rate_hz / settings.sensors;
  int64_t frequency = 0;
  if (!coprocessor_frequency_word(settings.frequency_hz, period * settings.sensors, clock_hz,
                                  &frequency) ||
      frequency == 0 || !adc_set_period(period)) {
    print_text("channels: the ADC refuses the sampling rate, or it does not fit the speed\n");
    return status_refused;
  }
  for (uint32_t i = 0; i < settings.sensors; ++i) {
    coprocessor_channel_open(i);
    prepare(frequency);
    if ((COPROCESSOR->CTRL & COPROCESSOR_CTRL_BLOCK_Msk) == 0) {
      print_text("channels: this coprocessor has no block learning\n");
      return status_no_channels;
    }
  }
  coprocessor_channel_close();
  NVIC_EnableIRQ(ADC_IRQn);
  adc_start(ADC_CTRL_IE_END_Msk);
  const bool complete = learn();
  adc_stop();
  if (!complete) print_text("channels: the signal has ended\n");
  return print_channels() == 0 && complete ? 0 : 1;
}
