// Exceptions as ARM DDI 0403, B1.5 has them: priorities, grouping and masks, nesting,
// tail-chaining, the stacks, what a handler sees of itself. All interrupts are pended by software,
// so nothing depends on time and every model prints the same.
#include <stdbool.h>
#include <stdio.h>

#include "core_cm3.h"
#include "handlers.h"

#define LINE_A 24
#define LINE_B 25
#define LINE_C 26

static char events[200];
static unsigned event_count;
static volatile exception_handler* vectors;

static void event(char what) {
  if (event_count < sizeof events - 1) events[event_count++] = what;
}

static void report(const char* what) {
  events[event_count] = 0;
  printf("%-12s %s\n", what, events);
  event_count = 0;
}

static uint32_t active_exception(void) {
  uint32_t ipsr;
  __asm volatile("mrs %0, ipsr" : "=r"(ipsr));
  return ipsr;
}

static void pend(int line) {
  NVIC->ISPR[0] = 1u << line;
  __DSB();
  __ISB();
}

static void set_basepri(uint32_t value) {
  __asm volatile("msr basepri, %0\n isb" ::"r"(value) : "memory");
}

static void handler_a(void) {
  event('a');
  pend(LINE_B);  // as urgent: waits; more urgent: preempts
  event('A');
}
static void handler_b(void) {
  event('b');
  pend(LINE_C);
  event('B');
}
static void handler_c(void) {
  event('c');
  event((char)('0' + (active_exception() - EXCEPTION_IRQ0) % 10));
  event((SCB->ICSR & 1u << 11) != 0 ? 'R' : 'r');  // RETTOBASE
  event('C');
}
static void handler_svc(void) {
  event('s');
  SCB->ICSR = 1u << 28;  // PendSV, of the same priority, waits
  __DSB();
  event('S');
}
static void handler_pendsv(void) {
  event('p');
}
static void handler_systick(void) {
  event('t');
}

static void priorities(uint32_t a, uint32_t b, uint32_t c) {
  NVIC_SetPriority(LINE_A, a);
  NVIC_SetPriority(LINE_B, b);
  NVIC_SetPriority(LINE_C, c);
}

static void nesting(void) {
  priorities(5, 3, 1);
  pend(LINE_A);
  report("nested");
  priorities(3, 3, 3);
  pend(LINE_A);
  report("chained");
  priorities(1, 3, 5);
  pend(LINE_A);
  report("in turn");
}

// PRIGROUP leaves one bit of three to the group: 4 to 7 are one, and 0 to 3.
static void grouping(void) {
  SCB->AIRCR = 0x05FA0000u | 6u << 8;
  priorities(7, 4, 2);
  pend(LINE_A);
  report("grouped");
  SCB->AIRCR = 0x05FA0000u;
}

static void masking(void) {
  priorities(4, 4, 4);
  __disable_irq();
  pend(LINE_C);
  event('-');
  __enable_irq();
  __ISB();
  report("primask");
  set_basepri(4 << 5);
  pend(LINE_C);
  event('-');
  set_basepri(5 << 5);
  event('+');
  set_basepri(0);
  report("basepri");
  __asm volatile("cpsid f" ::: "memory");
  pend(LINE_C);
  event('-');
  __asm volatile("cpsie f\n isb" ::: "memory");
  report("faultmask");
}

// The lowest number of the most urgent goes first.
static void order(void) {
  priorities(2, 2, 1);
  __disable_irq();
  NVIC->ISPR[0] = 1u << LINE_A | 1u << LINE_C;
  SCB->ICSR = 1u << 26 | 1u << 28;  // SysTick and PendSV
  __enable_irq();
  __ISB();
  report("order");
}

static void system_calls(void) {
  __asm volatile("svc #1" ::: "memory");
  report("svc");
  SCB->SHPR[7] = 0xE0;  // SVCall the least urgent: PendSV preempts it
  __asm volatile("svc #2" ::: "memory");
  SCB->SHPR[7] = 0;
  report("svc last");
}

__attribute__((used)) static struct { uint32_t exc_return, frame, sp_before, xpsr; } seen;

__attribute__((used)) static void note_frame(struct exception_frame* frame, uint32_t exc_return) {
  seen.exc_return = exc_return;
  seen.frame = (uint32_t)(uintptr_t)frame;
  seen.xpsr = frame->xpsr;
}
HANDLER_WITH_FRAME(handler_frame, note_frame)

// SVC with the stack pointer at a multiple of eight less `offset`.
#define CALL_WITH_OFFSET(offset)                                       \
  __asm volatile("mov r4, sp\n bic r5, r4, #7\n sub r5, r5, #" #offset \
                 "\n mov sp, r5\n"                                     \
                 "svc #3\n mov %0, sp\n mov sp, r4"                    \
                 : "=r"(seen.sp_before)::"r4", "r5", "memory")

static void stacks(void) {
  static uint32_t process_stack[64] __attribute__((aligned(8)));
  vectors[EXCEPTION_SVCALL] = handler_frame;
  CALL_WITH_OFFSET(8);
  printf("aligned      %08lx %lu %lu\n", (unsigned long)seen.exc_return,
         (unsigned long)(seen.sp_before - seen.frame), (unsigned long)(seen.xpsr >> 9 & 1));
  CALL_WITH_OFFSET(12);
  printf("misaligned   %08lx %lu %lu\n", (unsigned long)seen.exc_return,
         (unsigned long)(seen.sp_before - seen.frame), (unsigned long)(seen.xpsr >> 9 & 1));
  __asm volatile(
      "msr psp, %0\n mov r4, #2\n msr control, r4\n isb\n svc #4\n mov r4, #0\n msr control, r4\n "
      "isb" ::"r"(process_stack + 64)
      : "r4", "memory");
  printf("process      %08lx %lu\n", (unsigned long)seen.exc_return,
         (unsigned long)((uint32_t)(uintptr_t)(process_stack + 64) - seen.frame));
}

int main(void) {
  vectors = take_vectors();
  vectors[EXCEPTION_IRQ0 + LINE_A] = handler_a;
  vectors[EXCEPTION_IRQ0 + LINE_B] = handler_b;
  vectors[EXCEPTION_IRQ0 + LINE_C] = handler_c;
  vectors[EXCEPTION_SVCALL] = handler_svc;
  vectors[EXCEPTION_PENDSV] = handler_pendsv;
  vectors[EXCEPTION_SYSTICK] = handler_systick;
  NVIC->ISER[0] = 1u << LINE_A | 1u << LINE_B | 1u << LINE_C;
  nesting();
  grouping();
  masking();
  order();
  system_calls();
  stacks();
  return 0;
}
