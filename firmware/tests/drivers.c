// Every driver against its device. Status: the number of checks that failed; devices that are not
// there (as on a plain AN385) are named and skipped.
#include <stdbool.h>
#include <stdint.h>

#include "adc.h"
#include "an385.h"
#include "capsoc_device.h"
#include "clock.h"
#include "console.h"
#include "coprocessor.h"
#include "fixed_print.h"
#include "gpio.h"
#include "sleep.h"
#include "timer.h"
#include "uart.h"

static int failures;

static void check(const char* what, bool passed) {
  print_text(what);
  print_text(passed ? ": ok\n" : ": FAILED\n");
  if (!passed) ++failures;
}

static volatile uint32_t timer_interrupts;

void TIMER0_Handler(void) {
  timer_expired(TIMER0);
  ++timer_interrupts;
}

static void check_uart(void) {
  const uint32_t divider = UART0->BAUDDIV;
  const uint32_t clock = clock_frequency_hz();
  check("uart divider", divider == (clock + 57600) / 115200);
  uart_open(UART1, clock, 10000000);  // too fast: the smallest divider instead
  check("uart smallest divider", UART1->BAUDDIV == 16);
  check("uart nothing received", uart_read(UART1) == -1);
  UART1->CTRL = 0;
}

static void check_timer(void) {
  timer_start(TIMER1, 100000, false);
  const uint32_t first = timer_value(TIMER1);
  const uint32_t second = timer_value(TIMER1);
  check("timer counts down", second < first && first < 100000);
  timer_stop(TIMER1);
  NVIC_EnableIRQ(TIMER0_IRQn);
  timer_start(TIMER0, 2500, true);
  while (timer_interrupts < 3) sleep_while_equal(&timer_interrupts, timer_interrupts);
  timer_stop(TIMER0);
  NVIC_DisableIRQ(TIMER0_IRQn);
  check("timer interrupts", timer_interrupts >= 3 && !timer_expired(TIMER0));
}

static void check_gpio(void) {
  gpio_make_output(GPIO0, 0x0FF0);
  check("gpio direction", (GPIO0->OUTENSET & 0xFFFF) == 0x0FF0);
  gpio_write(GPIO0, 0xFFFF, 0);
  gpio_write(GPIO0, 0x0FF0, 0x0A50);
  check("gpio masked write", (GPIO0->DATAOUT & 0xFFFF) == 0x0A50);
  gpio_write(GPIO0, 0x0010, 0);
  check("gpio other pins keep", (GPIO0->DATAOUT & 0xFFFF) == 0x0A40);
  gpio_make_input(GPIO0, 0x0FF0);
  check("gpio input again", (GPIO0->OUTENSET & 0xFFFF) == 0);
}

static void check_clock(void) {
  check("clock reference", clock_frequency_hz() == AN385_CLOCK_HZ);
  check("clock refuses 6 GHz", !clock_use_pll(255, 1));
  console_flush();
  const bool doubled = clock_use_pll(2, 1) && clock_frequency_hz() == 2 * AN385_CLOCK_HZ;
  console_open(clock_frequency_hz(), 115200);
  check("clock 50 MHz", doubled);
  console_flush();
  clock_use_reference();
  console_open(clock_frequency_hz(), 115200);
  check("clock reference again", clock_frequency_hz() == AN385_CLOCK_HZ);
}

static void check_adc(void) {
  const uint32_t bits = ADC->BITS;
  check("adc period", adc_set_period(1000) && ADC->PERIOD == 1000);
  check("adc refuses a short period", !adc_set_period(31) && ADC->PERIOD == 1000);
  check("adc refuses 11 bits", !adc_set_bits(11) && ADC->BITS == bits);
  check("adc 16 bits", adc_set_bits(16) && ADC->BITS == 16);
  adc_start(0);
  while (ADC->COUNT == 0 && !adc_ended()) {
  }
  check("adc samples", ADC->COUNT != 0 && (ADC->FLAGS & ADC_FLAGS_SAMPLE_Msk) != 0);
  check("adc left-justified", (ADC->DATA_U & 0xFFFF) == 0 && (ADC->DATA_V & 0xFFFF) == 0);
  adc_stop();
  check("adc stops", (ADC->STATUS & ADC_STATUS_RUNNING_Msk) == 0);
  adc_set_bits(bits);
}

static void check_coprocessor_registers(void) {
  const int64_t frequencies[] = {56294995342, -56294995342, 1, -1, -((int64_t)1 << 47)};
  bool same = true;
  for (unsigned i = 0; i < sizeof frequencies / sizeof frequencies[0]; ++i) {
    coprocessor_set_frequency(frequencies[i]);
    same &= coprocessor_frequency() == frequencies[i];
  }
  check("coprocessor frequency", same);
  coprocessor_set_phase(UINT64_C(0xFEDCBA987654));
  check("coprocessor phase", coprocessor_phase() == UINT64_C(0xFEDCBA987654));
  const int64_t one = (int64_t)1 << 46;
  const int64_t coefficients[] = {0, 1, -1, one / 3, -one / 3, 16384, 16383, 2 * one - 1, -2 * one};
  same = true;
  for (unsigned i = 0; i < sizeof coefficients / sizeof coefficients[0]; ++i) {
    const enum coprocessor_coefficient which = (enum coprocessor_coefficient)(i % 6);
    coprocessor_set_coefficient(which, coefficients[i]);
    // Beyond +-1 the pair cannot say the value exactly: both words are saturated.
    const bool fits = coefficients[i] < one && coefficients[i] >= -one;
    same &= !fits || coprocessor_coefficient(which) == coefficients[i];
  }
  check("coprocessor coefficients", same);
  check("coprocessor steps", coprocessor_set_steps(1000) && COPROCESSOR->STEP_CV == 1000);
  check("coprocessor refuses a step of 1.0",
        !coprocessor_set_steps(0x80000000u) && COPROCESSOR->STEP_AU == 1000);
  coprocessor_set_loop(5, 12);
  check("coprocessor loop", COPROCESSOR->LOOP == (5u | 12u << 8));
  coprocessor_reset();
  check("coprocessor reset",
        COPROCESSOR->STEP_AU == COPROCESSOR_STEP_AU_Reset && coprocessor_frequency() == 0);
}

static bool wait_for_result(void) {
  for (unsigned turns = 0; turns < 10000; ++turns) {
    if ((COPROCESSOR->FLAGS & COPROCESSOR_FLAGS_RESULT_Msk) != 0) {
      COPROCESSOR->FLAGS = COPROCESSOR_FLAGS_RESULT_Msk;
      return true;
    }
  }
  return false;
}

static void check_coprocessor_sample(void) {
  coprocessor_reset();
  const struct coprocessor_parameters parameters = {.a1 = 1288490189, .a2 = 1288490189};  // 0.6
  coprocessor_load_parameters(&parameters);
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_CALIB_Msk;
  coprocessor_submit(911100150, 911100150);  // 0.6 sin 45 deg, 0.6 cos 45 deg
  check("coprocessor takes a sample", wait_for_result());
  // Within 64 units of 2^-32 turn of an eighth turn. The paper's arithmetic is coarser: its arc
  // tangent is good to some 1e-4 deg (1200 units).
  const bool paper = (COPROCESSOR->STATUS & COPROCESSOR_STATUS_ARITH_Msk) != 0;
  const int32_t error = (int32_t)(COPROCESSOR->ANGLE - 0x20000000u);
  const int32_t limit = paper ? 4096 : 64;
  check("coprocessor angle", error >= -limit && error <= limit);
  check("coprocessor counts it",
        COPROCESSOR->SAMPLES == 1 && (COPROCESSOR->STATUS & COPROCESSOR_STATUS_VALID_Msk) != 0);
  check("coprocessor keeps the raw sample", COPROCESSOR->RAW_U == 911100150);
  check("coprocessor latency", COPROCESSOR->LATENCY == 161);
  coprocessor_reset();
}

int main(void) {
  check_uart();
  check_timer();
  if (clock_present()) {
    check_gpio();
    check_clock();
  } else {
    print_text("no clock controller here, GPIO not checked\n");  // QEMU's board has neither
  }
  if (adc_present())
    check_adc();
  else
    print_text("no ADC here\n");
  if (coprocessor_present()) {
    check_coprocessor_registers();
    check_coprocessor_sample();
  } else {
    print_text("no coprocessor here\n");
  }
  print_text(failures == 0 ? "drivers: pass\n" : "drivers: fail\n");
  return failures;
}
