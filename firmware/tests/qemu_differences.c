// One line for each thing in which QEMU's mps2-an385 and this board differ and a program can
// continue after it; docs/reference/differences-from-qemu.md has both answers.
#include <stdio.h>

#include "an385.h"
#include "bus_probe.h"
#include "core_cm3.h"
#include "handlers.h"

__attribute__((used)) static volatile uint32_t resume, cfsr;
static volatile uint32_t ticks;

__attribute__((used)) static void note_fault(struct exception_frame* frame, uint32_t exc_return) {
  (void)exc_return;
  cfsr = SCB->CFSR;
  SCB->CFSR = cfsr;
  frame->pc = resume;
  frame->xpsr = (frame->xpsr & 0xF80003FFu) | 1u << 24;
}
HANDLER_WITH_FRAME(handle_fault, note_fault)

static void tick_handler(void) {
  if (++ticks == 3) {
    SCB->SCR = 0;
    SysTick->CTRL = 0;
  }
}

// The fault of a branch to `target`, or 0.
static unsigned long jump(uint32_t target) {
  cfsr = 0;
  __asm volatile("ldr r2, =1f\n str r2, %0\n bx %1\n .balign 2\n1:"
                 : "=m"(resume)
                 : "r"(target)
                 : "r0", "r1", "r2", "r3", "r12", "lr", "cc", "memory");
  return cfsr;
}

static void show_word(const char* what, uint32_t address) {
  uint32_t value;
  if (bus_probe(address, &value))
    printf("%s %08lx\n", what, (unsigned long)value);
  else
    printf("%s bus error\n", what);
}

static void devices(void) {
  show_word("ethernet", 0x40200050);
  show_word("spi", 0x40020FE0);
  show_word("coprocessor", 0x4000C000);
  show_word("adc", 0x4000D000);
  show_word("clock controller", 0x4000E000);
}

static void debug_registers(void) {
  CoreDebug->DEMCR = CoreDebug_DEMCR_TRCENA_Msk;
  DWT->CTRL |= DWT_CTRL_CYCCNTENA_Msk;
  const uint32_t before = DWT->CYCCNT;
  for (volatile int i = 0; i < 10; ++i) {
  }
  printf("demcr %08lx\n", (unsigned long)CoreDebug->DEMCR);
  printf("cyccnt %s\n", DWT->CYCCNT != before ? "runs" : "stands");
  printf("cpuid %08lx\n", (unsigned long)SCB->CPUID);
}

static void sleeping(void) {
  SysTick->LOAD = 2499;  // 0.1 ms
  SysTick->VAL = 0;
  SCB->SCR = SCB_SCR_SLEEPONEXIT_Msk;
  SysTick->CTRL = 7;
  __WFI();
  const uint32_t seen = ticks;
  SysTick->CTRL = 0;
  SCB->SCR = 0;
  printf("sleeponexit %lu\n", (unsigned long)seen);
}

int main(void) {
  volatile exception_handler* const vectors = take_vectors();
  devices();
  for (int n = EXCEPTION_HARD_FAULT; n <= EXCEPTION_USAGE_FAULT; ++n) vectors[n] = handle_fault;
  vectors[EXCEPTION_SYSTICK] = tick_handler;
  SCB->SHCSR |= 0x00070000u;
  __DSB();
  debug_registers();
  printf("even address, halfword %08lx\n", jump(0x00000102));
  sleeping();
  return 0;
}
