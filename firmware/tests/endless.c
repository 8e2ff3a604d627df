// Ways never to end, for limits and signals of the host: `-P way=N`, in the order of `enum way`.
#include <stdint.h>

#include "adc.h"
#include "an385.h"
#include "capsoc_device.h"
#include "core_cm3.h"
#include "fixed_print.h"
#include "program_settings.h"
#include "timer.h"

#define SETTINGS(NUMBER, TEXT) NUMBER(uint32_t, way, 0, 0, 23, 1, "", "which one")
PROGRAM_SETTINGS(SETTINGS)

enum way {
  COMPUTE,
  WFI_ADC,  // asleep while a device has events
  WFE_ADC,
  WFI_FAST_ADC,
  WFI_TIMER,
  WFI_TICK,  // woken by an interrupt, to sleep again
  SLEEP_ON_EXIT,
  WFI_PENDING,   // never asleep: a masked interrupt is pending
  WFI_FOR_GOOD,  // nothing is left that could wake it
  POLL_GPIO,     // reads a device in a loop
  POLL_UART,
  POLL_TIMER,
  POLL_ADC,
  POLL_RUNNING_ADC,
  POLL_COPROCESSOR,
  POLL_SYSTICK,
  POLL_TWO,
  POLL_AND_COUNT,
  WRITE_GPIO,
  FEED_COPROCESSOR,
  PRINT,
  SEMIHOSTING_WRITE,
  SEMIHOSTING_READ,
  FAULT_AGAIN  // a handler that returns to the instruction that faults
};

enum { tick_cycles = AN385_CLOCK_HZ / 1000 };
enum semihosting { sys_write0 = 4, sys_readc = 7 };

void SysTick_Handler(void) {}
void HardFault_Handler(void) {}

static void read_for_ever(const volatile uint32_t* word) {
  for (;;) (void)*word;
}

static void call_host(uint32_t operation, const char* text) {
  register uint32_t r0 __asm("r0") = operation;
  register const char* r1 __asm("r1") = text;
  __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

static void run_adc(uint32_t period) {
  adc_set_period(period);
  adc_start(0);
}

static void start_tick(void) {
  SysTick->LOAD = tick_cycles - 1;
  SysTick->CTRL = SysTick_CTRL_ENABLE_Msk | SysTick_CTRL_TICKINT_Msk | SysTick_CTRL_CLKSOURCE_Msk;
}

static void sleep_for_ever(enum way way) {
  switch (way) {
    case WFE_ADC:
    case WFI_ADC:
      run_adc(100000);
      break;
    case WFI_FAST_ADC:
      run_adc(50);
      break;
    case WFI_TIMER:
      timer_start(TIMER0, 5000, false);
      break;
    case SLEEP_ON_EXIT:
      SCB->SCR |= SCB_SCR_SLEEPONEXIT_Msk;
      start_tick();
      break;
    case WFI_PENDING:
      __disable_irq();
      start_tick();
      break;
    case WFI_TICK:
      start_tick();
      break;
    default:
      break;
  }
  for (;;) {
    if (way == WFE_ADC)
      __asm volatile("wfe");
    else
      __WFI();
  }
}

int main(void) {
  const enum way way = (enum way)program_settings_values()->way;
  print_text("endless: begins\n");
  switch (way) {
    case COMPUTE:
      for (volatile uint32_t turns = 0;; ++turns) {
      }
    case POLL_GPIO:
      read_for_ever(&GPIO0->DATA);
      break;
    case POLL_UART:
      while ((UART1->STATE & CMSDK_UART_STATE_RXFULL_Msk) == 0) {
      }
      break;
    case POLL_TIMER:
      timer_start(TIMER0, 0xFFFFFFFF, false);
      read_for_ever(&TIMER0->VALUE);
      break;
    case POLL_RUNNING_ADC:
      run_adc(1000);
      read_for_ever(&ADC->STATUS);
      break;
    case POLL_ADC:
      read_for_ever(&ADC->STATUS);
      break;
    case POLL_COPROCESSOR:
      read_for_ever(&COPROCESSOR->STATUS);
      break;
    case POLL_SYSTICK:
      start_tick();
      read_for_ever(&SysTick->VAL);
      break;
    case POLL_TWO:
      for (;;) {
        (void)GPIO0->DATA;
        (void)UART1->STATE;
      }
    case POLL_AND_COUNT:
      for (volatile uint32_t turns = 0; (GPIO0->DATA & 0x8000u) == 0; ++turns) {
      }
      break;
    case WRITE_GPIO:
      for (uint32_t turns = 0;; ++turns) GPIO0->DATAOUT = turns;
    case FEED_COPROCESSOR:
      for (uint32_t turns = 0;; ++turns) {
        COPROCESSOR->SOFT_U = (int32_t)turns;
        COPROCESSOR->SOFT_V = (int32_t)turns;
      }
    case PRINT:
      for (;;) print_text("endless: still there\n");
    case SEMIHOSTING_WRITE:
      for (;;) call_host(sys_write0, "endless: still there\n");
    case SEMIHOSTING_READ:
      for (;;) call_host(sys_readc, 0);
    case FAULT_AGAIN:
      __asm volatile("udf #0");
      break;
    default:
      sleep_for_ever(way);
      break;
  }
  return 0;
}
