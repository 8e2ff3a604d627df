// Two threads under a small kernel of the usual shape: SVC starts, PendSV switches, a system call
// prints. Each thread runs unprivileged on its process stack; the MPU lets it write only there. A
// thread that writes to the other thread's stack is ended.
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "core_cm3.h"
#include "handlers.h"

#define MPU_CTRL (*(volatile uint32_t*)0xE000ED94u)
#define MPU_RNR (*(volatile uint32_t*)0xE000ED98u)
#define MPU_RBAR (*(volatile uint32_t*)0xE000ED9Cu)
#define MPU_RASR (*(volatile uint32_t*)0xE000EDA0u)
#define STACK_WORDS 256
#define STACK_BITS 10
#define PENDSVSET (1u << 28)

enum system_call { CALL_YIELD, CALL_PRINT, CALL_END };

struct thread {
  uint32_t* stack_pointer;  // of the saved context; first, for switch_context
  bool ended;
  uint32_t stack[STACK_WORDS] __attribute__((aligned(1 << STACK_BITS)));
};
static struct thread threads[2];
__attribute__((used)) static struct thread* current = &threads[0];

static void protect(const struct thread* thread) {
  MPU_RNR = 2;
  MPU_RBAR = (uint32_t)(uintptr_t)thread->stack;
  MPU_RASR = 3u << 24 | (STACK_BITS - 1) << 1 | 1u;
}

__attribute__((used)) static uint32_t* next_thread(uint32_t* stack_pointer) {
  current->stack_pointer = stack_pointer;
  struct thread* const other = current == &threads[0] ? &threads[1] : &threads[0];
  if (!other->ended) current = other;
  if (current->ended) {
    puts("all ended");
    exit(0);
  }
  protect(current);
  return current->stack_pointer;
}

__attribute__((naked)) static void switch_context(void) {
  __asm volatile(
      "mrs r0, psp\n stmdb r0!, {r4-r11}\n push {r4, lr}\n bl next_thread\n pop {r4, lr}\n"
      "ldmia r0!, {r4-r11}\n msr psp, r0\n bx lr");
}

__attribute__((used)) static void system_call(struct exception_frame* frame, uint32_t exc_return) {
  (void)exc_return;
  switch ((enum system_call)frame->r0) {
    case CALL_PRINT:
      printf("thread %u: %lu\n", (unsigned)(current - threads), (unsigned long)frame->r1);
      break;
    case CALL_END:
      current->ended = true;
      SCB->ICSR = PENDSVSET;
      break;
    default:
      SCB->ICSR = PENDSVSET;
  }
}
HANDLER_WITH_FRAME(handle_svc, system_call)

__attribute__((used)) static void violation(struct exception_frame* frame, uint32_t exc_return) {
  (void)exc_return;
  (void)frame;
  printf("thread %u: violation, cfsr %02lx, in its neighbour: %d\n", (unsigned)(current - threads),
         (unsigned long)SCB->CFSR, SCB->MMFAR == (uint32_t)(uintptr_t)&threads[0].stack[4]);
  SCB->CFSR = 0xFF;
  current->ended = true;
  SCB->ICSR = PENDSVSET;
}
HANDLER_WITH_FRAME(handle_violation, violation)

static void call(enum system_call which, uint32_t argument) {
  register uint32_t r0 __asm("r0") = which;
  register uint32_t r1 __asm("r1") = argument;
  __asm volatile("svc #0" : "+r"(r0) : "r"(r1) : "memory");
}

static uint32_t fibonacci(uint32_t n) {
  return n < 2 ? n : fibonacci(n - 1) + fibonacci(n - 2);
}

static void count(uint32_t turns) {
  for (uint32_t i = 0; i < turns; ++i) {
    call(CALL_PRINT, fibonacci(6 + i));
    call(CALL_YIELD, 0);
  }
  call(CALL_END, 0);
}

static void trespass(uint32_t turns) {
  for (uint32_t i = 0; i < turns; ++i) {
    call(CALL_PRINT, i * i);
    call(CALL_YIELD, 0);
  }
  threads[0].stack[4] = 1;
  call(CALL_PRINT, 999);
}

static void prepare(struct thread* thread, void (*body)(uint32_t), uint32_t argument) {
  uint32_t* sp = thread->stack + STACK_WORDS;
  *--sp = 1u << 24;
  *--sp = (uint32_t)(uintptr_t)body & ~1u;
  *--sp = 0;                              // lr
  for (int n = 0; n < 4; ++n) *--sp = 0;  // r12, r3 to r1
  *--sp = argument;                       // r0
  for (int n = 4; n < 12; ++n) *--sp = (uint32_t)n;
  thread->stack_pointer = sp;
}

// Continues as the first thread: its context is unstacked as PendSV would, then it is entered
// without privilege. The main stack is left to the handlers.
__attribute__((naked)) static void start_first(void) {
  __asm volatile(
      "ldr r0, =current\n ldr r0, [r0]\n ldr r0, [r0]\n adds r0, #32\n ldm r0, {r0-r3}\n"
      "ldr r12, =current\n ldr r12, [r12]\n ldr r12, [r12]\n add r12, r12, #64\n"
      "msr psp, r12\n ldr r4, [r12, #-8]\n mov r5, #3\n msr control, r5\n isb\n"
      "orr r4, r4, #1\n bx r4\n .ltorg");
}

int main(void) {
  volatile exception_handler* const vectors = take_vectors();
  vectors[EXCEPTION_SVCALL] = handle_svc;
  vectors[EXCEPTION_PENDSV] = switch_context;
  vectors[EXCEPTION_MEM_MANAGE] = handle_violation;
  SCB->SHCSR |= 1u << 16;
  SCB->SHPR[10] = 0xE0;  // PendSV is the least urgent
  prepare(&threads[0], count, 6);
  prepare(&threads[1], trespass, 3);
  MPU_RNR = 0;
  MPU_RBAR = 0;
  MPU_RASR = 6u << 24 | 21u << 1 | 1u;  // code, read-only
  protect(&threads[0]);
  MPU_CTRL = 5;
  __DSB();
  __ISB();
  start_first();
  return 1;
}
