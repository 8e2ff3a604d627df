// Self-calibration at a known speed, as in the paper: demodulate for 400 s against the numeric
// reference, store the six parameters, then calibrate with the stored ones for one revolution.
//
// Status: 0 pass, 1 no lock or a flag that must not be raised, 2 the ADC refuses the settings,
// 3 no coprocessor on this board.
#include <stdbool.h>
#include <stdint.h>

#include "adc.h"
#include "angle_report.h"
#include "capsoc_device.h"
#include "clock.h"
#include "console.h"
#include "coprocessor.h"
#include "fixed_print.h"
#include "parameter_report.h"
#include "sampling.h"
#include "supervision.h"

static const struct {
  uint32_t baud;
  uint32_t rate_hz;
  int64_t frequency;  // 2^-48 turn a sample: 0.05 Hz / 250 Hz
  uint32_t step;      // 2 mu in Q1.31: omega / 2, the fastest that settles
  uint32_t demodulation_samples;
  uint32_t calibration_samples;  // one revolution at 0.05 Hz
  uint32_t progress_seconds;
  uint32_t mirror_seconds;
  uint32_t angle_stride;  // samples from one printed angle to the next
} settings = {
    .baud = 115200,
    .rate_hz = 250,
    .frequency = 56294995342,
    .step = 1349307,
    .demodulation_samples = 100000,
    .calibration_samples = 5000,
    .progress_seconds = 50,
    .mirror_seconds = 5,
    .angle_stride = 250,
};

enum { status_refused = 2, status_no_coprocessor = 3 };

static void print_banner(uint32_t clock_hz) {
  print_text("selfcal: self-calibration at a known speed\n");
  print_text("clock ");
  print_unsigned(clock_hz, 0);
  print_text(" Hz, ");
  print_unsigned(settings.rate_hz, 0);
  print_text(" samples/s, ");
  print_unsigned(ADC->BITS, 0);
  print_text(" bits, ");
  const uint32_t status = COPROCESSOR->STATUS;
  const bool paper = (status & COPROCESSOR_STATUS_ARITH_Msk) != 0;
  print_text(paper ? "paper arithmetic\n" : "precise arithmetic\n");
}

static bool calibrate(const struct coprocessor_parameters* stored, uint32_t first) {
  print_text("calibration with the stored parameters\n");
  print_parameter_table(stored);
  return print_angles(first, settings.calibration_samples, settings.angle_stride);
}

int main(void) {
  const uint32_t clock_hz = clock_frequency_hz();
  console_open(clock_hz, settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("selfcal: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_banner(clock_hz);
  console_start_buffering();

  coprocessor_reset();
  coprocessor_set_frequency(settings.frequency);
  coprocessor_set_steps(settings.step);
  const uint32_t gates =
      COPROCESSOR_CTRL_CALIB_Msk | COPROCESSOR_CTRL_ADC_Msk | COPROCESSOR_CTRL_IE_RESULT_Msk;
  COPROCESSOR->CTRL = gates | COPROCESSOR_CTRL_DEMOD_Msk;
  if (!sampling_start(settings.rate_hz)) {
    print_text("selfcal: the ADC refuses the sampling rate\n");
    return status_refused;
  }

  struct supervision state = {
      .name = "selfcal", .rate_hz = settings.rate_hz, .mirror_seconds = settings.mirror_seconds};
  const bool complete =
      demodulate(&state, settings.demodulation_samples, settings.progress_seconds);
  // Before anything is printed: the next sample is already one of the calibration.
  const struct coprocessor_parameters stored = coprocessor_read_parameters();
  const uint32_t demodulated = sampling_count();
  COPROCESSOR->CTRL = gates;
  coprocessor_load_parameters(&stored);
  if (!complete) {
    print_end(demodulated);
    print_parameter_table(&stored);
  } else if (!calibrate(&stored, demodulated)) {
    print_end(sampling_count());
  }
  sampling_stop();
  return verdict(&state);
}
