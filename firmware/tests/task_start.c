// Starts a task as schedulers do: a frame is laid on the process stack by hand, and the handler of
// SVCall returns to it. The stacked PC is the function's address as C has it, with bit 0 set.
#include "fixed_print.h"
#include "handlers.h"
#include "semihosting.h"

enum { words = 256 };

static uint32_t stack[words] __attribute__((aligned(8)));

static void task(void) {
  print_text("task_start: runs\n");
  semihosting_exit(0);
}

__attribute__((naked)) static void start_task(void) {
  __asm volatile("msr psp, r0\n mvn lr, #2\n bx lr");  // EXC_RETURN 0xFFFFFFFD
}

int main(void) {
  take_vectors()[EXCEPTION_SVCALL] = start_task;
  struct exception_frame* const frame = (struct exception_frame*)(stack + words) - 1;
  *frame = (struct exception_frame){.pc = (uint32_t)(uintptr_t)task, .xpsr = 1u << 24};
  register uint32_t top __asm("r0") = (uint32_t)(uintptr_t)frame;
  __asm volatile("svc #0" ::"r"(top) : "memory");
  return 1;
}
