// The devices of the AN385 that the coprocessor's programs do without: dual timer, watchdog,
// FPGAIO and SCC. The watchdog's reset brings the program back to its start, where the PSRAM, which
// no reset touches, says that it has been here before. Prints nothing that depends on speed, so
// every model of the board gives the same bytes. Status: the number of checks that failed.
#include <stdbool.h>
#include <stdint.h>

#include "an385.h"
#include "console.h"
#include "fixed_print.h"
#include "sleep.h"

#define SECOND_BOOT 0x2d5ec0deu

struct boot_record {
  uint32_t magic;
  uint32_t failures;
  uint32_t nmis;
};
#define BOOT ((volatile struct boot_record*)0x21000000u)

typedef struct {
  __IO uint32_t LOAD;
  __I uint32_t VALUE;
  __IO uint32_t CONTROL;
  __O uint32_t INTCLR;
  __I uint32_t RIS;
  __I uint32_t MIS;
  __IO uint32_t BGLOAD;
  uint32_t reserved;
} dual_timer_unit;
#define DUAL_TIMER ((dual_timer_unit*)0x40002000u)
#define DUAL_ONE_SHOT 0x01u
#define DUAL_32_BIT 0x02u
#define DUAL_PRESCALE_16 0x04u
#define DUAL_INTERRUPT 0x20u
#define DUAL_PERIODIC 0x40u
#define DUAL_ENABLE 0x80u

typedef struct {
  __IO uint32_t LOAD;
  __I uint32_t VALUE;
  __IO uint32_t CONTROL;
  __O uint32_t INTCLR;
  __I uint32_t RIS;
  __I uint32_t MIS;
  uint32_t reserved[762];
  __IO uint32_t LOCK;
} watchdog;
#define WATCHDOG ((watchdog*)0x40008000u)
#define WATCHDOG_INTERRUPT 1u
#define WATCHDOG_RESET 2u
#define WATCHDOG_UNLOCK 0x1ACCE551u

#define FPGAIO_LED0 (*(volatile uint32_t*)0x40028000u)
#define FPGAIO_CLK100HZ (*(volatile uint32_t*)0x40028014u)
#define FPGAIO_COUNTER (*(volatile uint32_t*)0x40028018u)
#define FPGAIO_PRESCALE (*(volatile uint32_t*)0x4002801Cu)
#define SCC_ID (*(volatile uint32_t*)0x4002FFFCu)
#define SCC_AID (*(volatile uint32_t*)0x4002FFF8u)

static void check(const char* what, bool passed) {
  print_text(what);
  print_text(passed ? ": ok\n" : ": FAILED\n");
  if (!passed) ++BOOT->failures;
}

static volatile uint32_t dual_interrupts;

void DUALTIMER_Handler(void) {
  for (unsigned i = 0; i < 2; ++i) {
    if (DUAL_TIMER[i].MIS == 0) continue;
    DUAL_TIMER[i].INTCLR = 1;
    ++dual_interrupts;
  }
}

void NMI_Handler(void) {
  ++BOOT->nmis;
  // The first bark is answered; after the second the dog bites.
  if (BOOT->nmis == 1) WATCHDOG->INTCLR = 1;
}

static void wait_for(uint32_t count) {
  while (dual_interrupts < count) sleep_while_equal(&dual_interrupts, dual_interrupts);
}

static void check_dual_timer(void) {
  check("dual timer at rest", DUAL_TIMER[0].VALUE == 0xffffffffu && DUAL_TIMER[1].CONTROL == 0x20);
  NVIC_EnableIRQ(DUALTIMER_IRQn);
  DUAL_TIMER[0].CONTROL = DUAL_32_BIT | DUAL_INTERRUPT | DUAL_PERIODIC;
  DUAL_TIMER[0].LOAD = 50000;
  DUAL_TIMER[0].CONTROL = DUAL_32_BIT | DUAL_INTERRUPT | DUAL_PERIODIC | DUAL_ENABLE;
  wait_for(3);
  DUAL_TIMER[0].CONTROL = 0;
  check("dual timer periodic", dual_interrupts >= 3);
  dual_interrupts = 0;
  DUAL_TIMER[1].CONTROL = DUAL_32_BIT | DUAL_INTERRUPT | DUAL_PERIODIC;
  DUAL_TIMER[1].LOAD = 2000;
  DUAL_TIMER[1].CONTROL =
      DUAL_32_BIT | DUAL_INTERRUPT | DUAL_PERIODIC | DUAL_PRESCALE_16 | DUAL_ONE_SHOT | DUAL_ENABLE;
  wait_for(1);
  check("dual timer one shot", DUAL_TIMER[1].VALUE == 0 && DUAL_TIMER[1].RIS == 0);
  DUAL_TIMER[1].CONTROL = 0;
  NVIC_DisableIRQ(DUALTIMER_IRQn);
}

static void check_board(void) {
  check("scc", SCC_ID == 0x41043850u && SCC_AID == 0x00200008u);
  FPGAIO_LED0 = 2;
  check("led", FPGAIO_LED0 == 2);
  FPGAIO_LED0 = 0;
  const uint32_t start = FPGAIO_CLK100HZ;
  const uint32_t cycles = FPGAIO_COUNTER;
  while (FPGAIO_CLK100HZ - start < 2) {
  }
  const uint32_t elapsed = FPGAIO_COUNTER - cycles;
  check("board clock", elapsed > 200000 && elapsed < 25000000);
}

static void provoke_watchdog(void) {
  WATCHDOG->LOCK = 0;
  WATCHDOG->CONTROL = WATCHDOG_INTERRUPT | WATCHDOG_RESET;
  check("watchdog lock", WATCHDOG->LOCK == 1 && WATCHDOG->CONTROL == 0);
  WATCHDOG->LOCK = WATCHDOG_UNLOCK;
  WATCHDOG->LOAD = 100000;
  console_flush();
  BOOT->magic = SECOND_BOOT;
  WATCHDOG->CONTROL = WATCHDOG_INTERRUPT | WATCHDOG_RESET;
  for (;;) {
  }
}

int main(void) {
  if (BOOT->magic != SECOND_BOOT) {
    BOOT->failures = 0;
    BOOT->nmis = 0;
    check_dual_timer();
    check_board();
    provoke_watchdog();
  }
  BOOT->magic = 0;
  print_text("back after the watchdog's reset\n");
  check("two barks", BOOT->nmis == 2);
  check("watchdog at rest", WATCHDOG->CONTROL == 0 && WATCHDOG->LOAD == 0xffffffffu);
  check("dual timer at rest", DUAL_TIMER[0].CONTROL == 0x20 && DUAL_TIMER[0].VALUE == 0xffffffffu);
  print_text(BOOT->failures == 0 ? "board: pass\n" : "board: fail\n");
  return (int)BOOT->failures;
}
