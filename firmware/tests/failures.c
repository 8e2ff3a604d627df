// Failures that a report has to explain, one a run: -P failure=N. The lines that are to blame are
// marked for the tests.
#include <stdbool.h>
#include <stdint.h>

#include "an385.h"
#include "core_cm3.h"
#include "fixed_print.h"
#include "program_settings.h"
#include "timer.h"

#define SETTINGS(NUMBER, TEXT) NUMBER(uint32_t, failure, 1, 1, 9, 1, "", "which one")
PROGRAM_SETTINGS(SETTINGS)

enum failure {
  NULL_WRITE = 1,
  OVERFLOW,
  SVC_PRIORITY,
  DEADLOCK,
  ASLEEP,
  LOST_WRITE,
  FAILED_CHECK,
  FAULT_IN_HANDLER,
  PRINTED_WARNING
};

struct node {
  uint32_t keys[16];
  struct node* next;
};

static struct node* volatile last_node;
static uint32_t failure;
static volatile bool answered;
static volatile uint32_t zero;
static uint32_t process_stack[128];

#define NEVER_INLINE __attribute__((noinline))

// A missing check for the end of a list: `next` is null, and the vector table is RAM.
NEVER_INLINE static void set_key(struct node* node, uint32_t index, uint32_t key) {
  node->keys[index] = key;  // null write
}

NEVER_INLINE static void null_write(void) {
  set_key(last_node, 15, 0x1234);
  SysTick->LOAD = 100;
  SysTick->CTRL = SysTick_CTRL_ENABLE_Msk | SysTick_CTRL_TICKINT_Msk | SysTick_CTRL_CLKSOURCE_Msk;
  for (;;) __WFI();
}

NEVER_INLINE static uint32_t descend(uint32_t depth) {
  volatile uint32_t frame[16];
  frame[depth % 16] = depth;
  if (depth == 1000) return 0;
  return descend(depth + 1) + frame[depth % 16];  // overflow
}

NEVER_INLINE static void call_kernel(void) {
  __asm volatile("svc #1");  // svc priority
}

// TIMER0 has the priority that SVC has, so its handler may make no system call.
NEVER_INLINE static void wait_for_answer(void) {
  while (!answered) {  // deadlock
  }
}

void TIMER0_Handler(void) {
  timer_expired(TIMER0);
  timer_stop(TIMER0);
  if (failure == SVC_PRIORITY) call_kernel();
  if (failure == DEADLOCK) wait_for_answer();
  if (failure == FAULT_IN_HANDLER) __asm volatile("udf #1");  // fault in handler
}

void TIMER1_Handler(void) {
  timer_expired(TIMER1);
  timer_stop(TIMER1);
  answered = true;
}

NEVER_INLINE static void start_timers(void) {
  NVIC_SetPriority(TIMER0_IRQn, 2);
  NVIC_SetPriority(TIMER1_IRQn, 5);
  SCB->SHPR[7] = 2 << 5;  // SVCall
  NVIC_EnableIRQ(TIMER0_IRQn);
  if (failure != ASLEEP) NVIC_EnableIRQ(TIMER1_IRQn);
  timer_start(TIMER0, 1000, true);
  timer_start(TIMER1, 1200, true);
}

NEVER_INLINE static void sleep_for_answer(void) {
  while (!answered) __WFI();  // asleep
}

static const char* volatile label = "a label";

NEVER_INLINE static void lost_write(volatile uint32_t* place) {
  const char* const text = label;
  uint32_t* const top = process_stack + 128 - 4;
  place[2] = 0xABCD;  // lost write
  while (zero == 0) {
  }
  *top = zero;
  print_text(text);
}

NEVER_INLINE static void check(bool good, const char* what) {
  if (good) return;
  print_text("FAIL: ");
  print_text(what);
  print_text("\n");
  answered = true;  // no tail call
}

NEVER_INLINE static void run_checks(void) {
  check(zero == 0, "zero");
  check(zero == 1, "one");  // failed check
  for (volatile uint32_t i = 0; i < 100000; ++i) {
  }
}

// A thread of its own stack, interrupted by a handler that faults.
NEVER_INLINE static uint32_t work(uint32_t sum) {
  while (zero == 0) ++sum;
  return sum;
}

NEVER_INLINE static void thread(void) {
  start_timers();
  zero = work(1) + 1;
}

NEVER_INLINE static void run_thread(void) {
  __asm volatile("msr psp, %0\n mov r0, #2\n msr control, r0\n isb" ::"r"(process_stack + 128)
                 : "r0", "memory");
  thread();
  __asm volatile("mov r0, #0\n msr control, r0\n isb" ::: "r0", "memory");
}

NEVER_INLINE static void warn(void) {
  SCB->SHPR[7] = 0x11;  // printed warning
}

int main(void) {
  failure = program_settings_values()->failure;
  switch ((enum failure)failure) {
    case NULL_WRITE:
      null_write();
      break;
    case OVERFLOW:
      zero = descend(0);
      break;
    case SVC_PRIORITY:
    case DEADLOCK:
      start_timers();
      sleep_for_answer();
      break;
    case ASLEEP:
      start_timers();
      sleep_for_answer();
      break;
    case LOST_WRITE:
      lost_write((volatile uint32_t*)0x60000000);
      break;
    case FAILED_CHECK:
      run_checks();
      break;
    case FAULT_IN_HANDLER:
      run_thread();
      break;
    case PRINTED_WARNING:
      warn();
      break;
  }
  return 0;
}
