// Calls of every kind, for the function profile: plain ones, tail calls, recursion, longjmp, an
// exception, and two threads that a PendSV handler switches between as an RTOS does.
#include <setjmp.h>
#include <stdint.h>

#include "core_cm3.h"

#define NOINLINE __attribute__((noinline, noclone))

static volatile uint32_t sink;
static jmp_buf place;

uint32_t* other_stack;  // of the thread that does not run; used by PendSV_Handler

void SVC_Handler(void);
void PendSV_Handler(void);

NOINLINE static void leaf(uint32_t rounds) {
  for (uint32_t i = 0; i < rounds; ++i) sink = sink + i;
}

NOINLINE static void plain(void) {
  leaf(10);
  sink = sink + 1;
}

NOINLINE static void tail(void) {
  sink = sink + 1;
  leaf(20);  // the last thing it does: a branch and no call
}

NOINLINE static uint32_t recursive(uint32_t depth) {
  if (depth == 0) return sink;
  return recursive(depth - 1) + sink;
}

NOINLINE static void thrower(void) {
  leaf(5);
  longjmp(place, 1);
}

NOINLINE static void outer(void) {
  thrower();
  sink = sink + 1;
}

void SVC_Handler(void) {
  leaf(30);
}

// Exchanges the process stack with the other thread's, R4 to R11 on top.
__attribute__((naked)) void PendSV_Handler(void) {
  __asm volatile(
      "mrs r0, psp\n stmdb r0!, {r4-r11}\n"
      "ldr r1, =other_stack\n ldr r2, [r1]\n str r0, [r1]\n"
      "ldmia r2!, {r4-r11}\n msr psp, r2\n bx lr\n .ltorg");
}

NOINLINE static void yield(void) {
  SCB->ICSR = 1u << 28;  // PENDSVSET
  __DSB();
  __ISB();
}

NOINLINE static void work_a(void) {
  leaf(100);
}

NOINLINE static void work_b(void) {
  leaf(200);
}

NOINLINE static void thread_a(void) {
  for (int i = 0; i < 5; ++i) {
    work_a();
    yield();
  }
}

NOINLINE static void thread_b(void) {
  for (;;) {
    work_b();
    yield();
  }
}

// Calls `thread` on a process stack.
__attribute__((naked, noinline)) static void run_on(uint32_t* top, void (*thread)(void)) {
  (void)top, (void)thread;
  __asm volatile(
      "push {r4, lr}\n msr psp, r0\n movs r2, #2\n msr control, r2\n isb\n blx r1\n"
      "movs r2, #0\n msr control, r2\n isb\n pop {r4, pc}");
}

int main(void) {
  static uint32_t stack_a[128], stack_b[128];
  for (int i = 0; i < 3; ++i) plain();
  for (int i = 0; i < 2; ++i) tail();
  recursive(4);
  if (setjmp(place) == 0) outer();
  __asm volatile("svc 0");
  other_stack = stack_b + 128 - 16;  // R4 to R11, then the frame that the return unstacks
  other_stack[14] = (uint32_t)thread_b & ~1u;
  other_stack[15] = 1u << 24;
  run_on(stack_a + 128, thread_a);
  return 0;
}
