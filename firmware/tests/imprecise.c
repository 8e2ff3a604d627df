// A store to nowhere through the write buffer: on a Cortex-M3 the BusFault is imprecise, on QEMU it
// is precise. Prints which, and 0 or the offset of the return address from the store.
#include <stdio.h>

#include "core_cm3.h"
#include "handlers.h"

__attribute__((used)) static volatile uint32_t cfsr, pc;

__attribute__((used)) static void note_fault(struct exception_frame* frame, uint32_t exc_return) {
  (void)exc_return;
  cfsr = SCB->CFSR;
  pc = frame->pc;
  SCB->CFSR = cfsr;
  // After the store, wherever that is: a precise one would be repeated.
  if ((cfsr & 1u << 9) != 0) frame->pc += 2;
}
HANDLER_WITH_FRAME(handle_fault, note_fault)

int main(void) {
  volatile exception_handler* const vectors = take_vectors();
  vectors[EXCEPTION_BUS_FAULT] = handle_fault;
  SCB->SHCSR |= SCB_SHCSR_BUSFAULTENA_Msk;
  __DSB();
  uint32_t at;
  __asm volatile("ldr %0, =1f\n mov r0, %1\n1: str r0, [r0]\n nop\n dsb"
                 : "=&r"(at)
                 : "r"(0x60000000u)
                 : "r0", "memory");
  printf("%s pc %+ld\n", (cfsr & 1u << 10) != 0 ? "IMPRECISERR" : "PRECISERR",
         (long)(int32_t)(pc - (at & ~1u)));
  return 0;
}
