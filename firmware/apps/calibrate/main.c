// Calibration mode from the first sample, with parameters that were obtained by other methods and
// written in the program (the SoC paper, section 4.3). See parameter_block.h for how they get here.
//
// The reference is the calibrated angle itself, so the error that is shown at the end says how well
// the parameters fit this sensor, whatever its motion.
//
// Judged by whole turns of the shaft; samples in any order by windows of window_samples, which must
// hold every part of the turn.
//
// Status: 0 pass, 1 a verdict of fail, 2 the ADC refuses the
// settings, 3 no coprocessor on this board, 4 the program image has no parameters.
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "adc.h"
#include "angle_report.h"
#include "capsoc_device.h"
#include "clock.h"
#include "common_settings.h"
#include "console.h"
#include "coprocessor.h"
#include "fixed_print.h"
#include "judgement.h"
#include "parameter_block.h"
#include "parameter_report.h"
#include "program_settings.h"
#include "program_verdict.h"
#include "sampling.h"
#include "sensor_change.h"
#include "supervision.h"

#define SETTINGS(NUMBER, TEXT)                                                 \
  BAUD_SETTING(NUMBER)                                                         \
  RATE_SETTING(NUMBER)                                                         \
  NUMBER(uint32_t, samples, 5000, 1, 1e9, 1, "samples", "one turn at 0.05 Hz") \
  NUMBER(uint32_t, window_samples, 0, 0, 1e9, 1, "samples",                    \
         "that are judged together; 0: those of a turn")                       \
  HARMONICS_SETTING(NUMBER)                                                    \
  LIMIT_SETTING(NUMBER)                                                        \
  ANGLE_STRIDE_SETTING(NUMBER)
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())

enum { status_refused = 2, status_no_coprocessor = 3, status_no_parameters = 4 };

enum { quarter_turn = 1 << 30 };

// beta beyond a quarter turn, as the SoC paper's Table 9 has it: the shaft turned against the
// reference that the parameters were found with. They say which way the angle counts.
static bool reversed(const struct coprocessor_parameters* parameters) {
  const int32_t beta = (int32_t)parameters->beta;
  return beta > quarter_turn || beta < -quarter_turn;
}

static bool paper_arithmetic(void) {
  return (COPROCESSOR->STATUS & COPROCESSOR_STATUS_ARITH_Msk) != 0;
}

// Before the first sample: nodes are taken only while no sample is under way. False where the
// coprocessor has no harmonic correction.
static bool load_table(void) {
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_CORRECT_Msk;
  if ((COPROCESSOR->CTRL & COPROCESSOR_CTRL_CORRECT_Msk) == 0) {
    COPROCESSOR->FLAGS = COPROCESSOR_FLAGS_CONFIG_Msk;
    return false;
  }
  while ((COPROCESSOR->STATUS & COPROCESSOR_STATUS_BUSY_Msk) != 0) {
  }
  for (uint32_t i = 0; i < sizeof calibration_table.nodes / sizeof calibration_table.nodes[0]; ++i)
    COPROCESSOR->CORRECTION =
        i << COPROCESSOR_CORRECTION_NODE_Pos |
        ((uint32_t)calibration_table.nodes[i] & COPROCESSOR_CORRECTION_VALUE_Msk);
  return true;
}

// The control bit of the harmonic correction, 0 without a table or where there is no correction.
static uint32_t correction(void) {
  if (calibration_table.valid != PARAMETER_BLOCK_VALID) return 0;
  if (load_table()) {
    print_text("the error table of the parameters is on\n");
    return COPROCESSOR_CTRL_CORRECT_Msk;
  }
  print_text("the error table is left out: this coprocessor corrects no harmonics\n");
  return 0;
}

static void print_banner(void) {
  print_text("calibrate: calibration mode with the parameters in the program\n");
  print_text(paper_arithmetic() ? "paper arithmetic\n" : "precise arithmetic\n");
}

static int judge(struct judgement* judgement) {
  print_text("error average ");
  print_q31((int32_t)COPROCESSOR->ERROR_AVERAGE, 0);
  print_text("\n");
  const char* reason = judgement_objection(judgement);
  if (reason != NULL) {
    const char* const change = sensor_change(&judgement->shape, &calibration_parameters.parameters);
    if (change != NULL) reason = change;
  }
  if (reason == NULL) reason = error_sentence(COPROCESSOR->FLAGS);
  if (reason != NULL) return fail_because("calibrate", reason);
  return pass("calibrate", judgement);
}

// False if the signal ended before.
static bool calibrate(struct judgement* judgement) {
  if (!print_angles(judgement, 0, settings.samples, settings.angle_stride)) return false;
  return judgement->whole != 0 || judgement_wait(judgement, COPROCESSOR->TURN_LIMIT);
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
  if (settings.window_samples > settings.samples) {
    print_text("calibrate: no window ends in so few samples: raise samples or lower ");
    print_text("window_samples\n");
    return status_refused;
  }
  console_start_buffering();

  const struct coprocessor_parameters* const parameters = &calibration_parameters.parameters;
  if (reversed(parameters) && paper_arithmetic())
    return fail_because("calibrate",
                        "beta is beyond a quarter turn, where Eq (12) is off by half a turn: write "
                        "pi - beta, and the angle counts the other way");
  coprocessor_reset();
  coprocessor_load_parameters(parameters);
  const uint32_t correct = correction();
  coprocessor_lock_by_turns();
  // Twice the time that is asked for: a turn in it may have begun anywhere.
  COPROCESSOR->TURN_LIMIT = settings.samples << 1;
  if (settings.window_samples != 0) {
    COPROCESSOR->TURN_LIMIT = settings.window_samples;
    COPROCESSOR->JUDGE |= COPROCESSOR_JUDGE_COUNT_Msk;
  }
  COPROCESSOR->CTRL = correct | COPROCESSOR_CTRL_CALIB_Msk | COPROCESSOR_CTRL_ADC_Msk |
                      COPROCESSOR_CTRL_IE_RESULT_Msk |
                      COPROCESSOR_CTRL_REF_ANGLE << COPROCESSOR_CTRL_REF_Pos;
  sampling_count_oddities();
  if (!sampling_start(settings.rate_hz)) {
    print_text("calibrate: the ADC refuses the sampling rate\n");
    return status_refused;
  }
  struct judgement judgement = {.limit = settings.limit_deg,
                                .unseen = settings.harmonics_deg,
                                .fewest = 1,
                                .watches = settings.window_samples == 0,
                                .mirrored = reversed(parameters),
                                .covers = true,
                                .has_parameters = true,
                                .parameters = *parameters};
  print_parameter_table(parameters);
  if (!calibrate(&judgement)) print_end(sampling_count());
  sampling_stop();
  judgement_finish(&judgement);
  return judge(&judgement);
}
