// Two tasks that yield to each other every thousand instructions or so, by PendSV as an RTOS does
// it: an exception, eight registers saved and eight loaded, and back on the other stack.
#include "bench.h"
#include "core_cm3.h"

enum { icsr_pendsv = 1 << 28, switches = 200000, stack_words = 256, turns = 160, saved_words = 16 };

static uint32_t stacks[2][stack_words] __attribute__((aligned(8)));
uint32_t* volatile other_stack;  // of the task that does not run
static volatile uint32_t done, sums[2];

// Exchanges the process stacks, r4 to r11 on them.
__attribute__((naked)) static void switch_tasks(void) {
  __asm volatile(
      "mrs r0, psp\n"
      "stmdb r0!, {r4-r11}\n"
      "ldr r1, =other_stack\n"
      "ldr r2, [r1]\n"
      "str r0, [r1]\n"
      "ldmia r2!, {r4-r11}\n"
      "msr psp, r2\n"
      "bx lr\n");
}

static void work(uint32_t number) {
  uint32_t x = number + 1;
  while (done < switches) {
    for (int turn = 0; turn < turns; ++turn) x = x * 1664525u + 1013904223u;
    sums[number] += x;
    ++done;
    SCB->ICSR = icsr_pendsv;
    __asm volatile("dsb\nisb" ::: "memory");
  }
}

static void second_task(void) {
  work(1);
  for (;;) SCB->ICSR = icsr_pendsv;
}

typedef void (*handler)(void);
static handler vectors[16] __attribute__((aligned(256)));

int main(void) {
  const handler* const before = (const handler*)SCB->VTOR;
  for (int n = 0; n < 16; ++n) vectors[n] = before[n];
  vectors[14] = switch_tasks;
  SCB->VTOR = (uint32_t)vectors;
  SCB->SHPR[10] = 0xFF;
  // r4 to r11, r0 to r3, r12, LR, PC, xPSR: as if it had been interrupted at its beginning.
  uint32_t* const frame = stacks[1] + stack_words - saved_words;
  frame[14] = (uint32_t)second_task;
  frame[15] = 1u << 24;
  other_stack = frame;
  __asm volatile(
      "msr psp, %0\n"
      "mov r0, #2\n"
      "msr control, r0\n"
      "isb\n"
      "mov r0, #0\n"
      "bl %1\n"
      "mov r0, #0\n"
      "msr control, r0\n"
      "isb\n" ::"r"(stacks[0] + stack_words),
      "i"(work)
      : "r0", "r1", "r2", "r3", "r12", "lr", "cc", "memory");
  return report("tasks", sums[0] ^ sums[1] * 31);
}
