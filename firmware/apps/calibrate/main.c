// Calibration mode from the first sample, with parameters that were obtained by other methods and
// written in the program (the SoC paper, section 4.3). See parameter_block.h for how they get here.
//
// The reference is the calibrated angle itself, so the error that is shown at the end says how well
// the parameters fit this sensor, whatever its motion.
//
// Status: 0 pass, 1 a flag that must not be raised or no valid angle, 2 the ADC refuses the
// settings, 3 no coprocessor on this board, 4 nobody wrote parameters in the program.
#include <stdbool.h>
#include <stdint.h>

#include "adc.h"
#include "angle_report.h"
#include "capsoc_device.h"
#include "clock.h"
#include "console.h"
#include "coprocessor.h"
#include "fixed_print.h"
#include "parameter_block.h"
#include "parameter_report.h"
#include "program_settings.h"
#include "sampling.h"

#define SETTINGS(NUMBER, TEXT)                                                 \
  NUMBER(uint32_t, baud, 115200, 300, 1500000, 1, "Bd", "of UART 0")           \
  NUMBER(uint32_t, rate_hz, 250, 1, 100000, 1, "Hz", "samples a second")       \
  NUMBER(uint32_t, samples, 5000, 1, 1e9, 1, "samples", "one turn at 0.05 Hz") \
  NUMBER(uint32_t, angle_stride, 250, 1, 1e9, 1, "samples", "from one printed angle to the next")
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_fail = 1, status_refused = 2, status_no_coprocessor = 3, status_no_parameters = 4 };

static void print_banner(void) {
  print_text("calibrate: calibration mode with the parameters in the program\n");
  const bool paper = (COPROCESSOR->STATUS & COPROCESSOR_STATUS_ARITH_Msk) != 0;
  print_text(paper ? "paper arithmetic\n" : "precise arithmetic\n");
}

static int verdict(void) {
  print_text("error average ");
  print_q31((int32_t)COPROCESSOR->ERROR_AVERAGE, 0);
  const uint32_t status = COPROCESSOR->STATUS;
  const bool locked = (status & COPROCESSOR_STATUS_LOCK_Msk) != 0;
  print_text(locked ? ": the parameters fit the sensor\n" : ": above the lock threshold\n");
  const uint32_t errors =
      COPROCESSOR->FLAGS & (COPROCESSOR_FLAGS_SAT_Msk | COPROCESSOR_FLAGS_EARLY_Msk |
                            COPROCESSOR_FLAGS_DIVERGED_Msk | COPROCESSOR_FLAGS_CONFIG_Msk);
  const bool good = errors == 0 && (status & COPROCESSOR_STATUS_VALID_Msk) != 0;
  print_text(good ? "calibrate: pass\n" : "calibrate: fail\n");
  return good ? 0 : status_fail;
}

int main(void) {
  console_open(clock_frequency_hz(), settings.baud);
  if (!coprocessor_present() || !adc_present()) {
    print_text("calibrate: no coprocessor here\n");
    return status_no_coprocessor;
  }
  print_banner();
  if (calibration_parameters.valid != PARAMETER_BLOCK_VALID) {
    print_text("calibrate: no parameters in the program\n");
    return status_no_parameters;
  }
  console_start_buffering();

  const struct coprocessor_parameters* const parameters = &calibration_parameters.parameters;
  coprocessor_reset();
  coprocessor_load_parameters(parameters);
  // A revolution of samples is no whole turn from angle to angle: LOCK without turns.
  COPROCESSOR->JUDGE &= ~COPROCESSOR_JUDGE_TURNS_Msk;
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_CALIB_Msk | COPROCESSOR_CTRL_ADC_Msk |
                      COPROCESSOR_CTRL_IE_RESULT_Msk |
                      COPROCESSOR_CTRL_REF_ANGLE << COPROCESSOR_CTRL_REF_Pos;
  if (!sampling_start(settings.rate_hz)) {
    print_text("calibrate: the ADC refuses the sampling rate\n");
    return status_refused;
  }
  print_parameter_table(parameters);
  if (!print_angles(0, settings.samples, settings.angle_stride)) print_end(sampling_count());
  sampling_stop();
  return verdict();
}
