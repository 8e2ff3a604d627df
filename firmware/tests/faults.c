// Every fault a program can make and survive: what the status registers say (B3.2.15 to B3.2.18),
// where the return address points, and the escalation of what is disabled. Stores are unbuffered
// here (ACTLR.DISDEFWBUF), for QEMU knows no imprecise bus fault; imprecise.c is about those.
#include <stdio.h>

#include "core_cm3.h"
#include "handlers.h"

#define ACTLR (*(volatile uint32_t*)0xE000E008u)
#define ACTLR_DISDEFWBUF 2u
#define SHCSR_FAULTS 0x00070000u
#define CFSR_BFARVALID (1u << 15)
#define CFSR_MMARVALID (1u << 7)

__attribute__((used)) static struct {
  uint32_t exception, cfsr, hfsr, address, pc, xpsr, count;
} fault;

// Set before each attempt: where the handler continues.
__attribute__((used)) static volatile uint32_t resume;

__attribute__((used)) static void note_fault(struct exception_frame* frame, uint32_t exc_return) {
  (void)exc_return;
  __asm volatile("mrs %0, ipsr" : "=r"(fault.exception));
  fault.cfsr = SCB->CFSR;
  fault.hfsr = SCB->HFSR;
  fault.address = (fault.cfsr & CFSR_BFARVALID) != 0   ? SCB->BFAR
                  : (fault.cfsr & CFSR_MMARVALID) != 0 ? SCB->MMFAR
                                                       : 0;
  fault.pc = frame->pc;
  fault.xpsr = frame->xpsr;
  ++fault.count;
  SCB->CFSR = fault.cfsr;  // write 1 to clear
  SCB->HFSR = fault.hfsr;
  frame->pc = resume;
  frame->xpsr = (frame->xpsr & 0xF80003FFu) | 1u << 24;
}
HANDLER_WITH_FRAME(handle_fault, note_fault)

// Executes `code` with r0 and r1 set; the fault comes at its label 1, and it continues at label 2.
#define ATTEMPT(what, first, second, code)                                                   \
  do {                                                                                       \
    uint32_t at;                                                                             \
    fault.count = 0;                                                                         \
    __asm volatile("mov r0, %2\n mov r1, %3\n ldr r2, =2f\n str r2, %1\n ldr %0, =1f\n" code \
                   "\n .balign 2\n2:\n"                                                      \
                   : "=&r"(at), "=m"(resume)                                                 \
                   : "r"((uint32_t)(first)), "r"((uint32_t)(second))                         \
                   : "r0", "r1", "r2", "r3", "r12", "lr", "cc", "memory");                   \
    show(what, at);                                                                          \
  } while (0)

static void show(const char* what, uint32_t at) {
  if (fault.count == 0) {
    printf("%-15s none\n", what);
    return;
  }
  printf("%-15s %lu cfsr %08lx hfsr %08lx address %08lx pc %+ld T %lu\n", what,
         (unsigned long)fault.exception, (unsigned long)fault.cfsr, (unsigned long)fault.hfsr,
         (unsigned long)fault.address, (long)(int32_t)(fault.pc - at),
         (unsigned long)(fault.xpsr >> 24 & 1));
}

static void attempts(void) {
  uint32_t words[4] = {0};
  const uint32_t odd = (uint32_t)(uintptr_t)words + 1;
  ATTEMPT("undefined", 0, 0, "1: udf #0");
  ATTEMPT("dsp", 0, 0, "1: .inst.w 0xfa80f000");  // SADD8
  ATTEMPT("coprocessor", 0, 0, "1: mcr p15, 0, r0, c0, c0, 0");
  // A5.3.18: these name a coprocessor, the last two are none of its instructions.
  ATTEMPT("ldc", 0, 0, "1: .inst.w 0xec900000");
  ATTEMPT("mcr2", 0, 0, "1: .inst.w 0xfe000010");
  ATTEMPT("no line of ldc", 0, 0, "1: .inst.w 0xec000000");
  ATTEMPT("simd ef", 0, 0, "1: .inst.w 0xef000110");
  ATTEMPT("simd ff", 0, 0, "1: .inst.w 0xff000110");
  ATTEMPT("divide by 0", 7, 0, "1: udiv r2, r0, r1");
  ATTEMPT("unaligned", odd, 0, "1: ldr r2, [r0]");
  ATTEMPT("byte is well", odd, 0, "1: ldrb r2, [r0]");
  ATTEMPT("ldrd", odd, 0, "1: ldrd r2, r3, [r0]");
  ATTEMPT("ldm", odd, 0, "1: ldm r0, {r2, r3}");
  ATTEMPT("ldrex", odd, 0, "1: ldrex r2, [r0]");
  ATTEMPT("load nowhere", 0x60000000, 0, "1: ldr r2, [r0]");
  ATTEMPT("store nowhere", 0x60000004, 0, "1: str r2, [r0]");
  ATTEMPT("stm nowhere", 0x60000008, 0, "1: stm r0!, {r1, r2}");
  ATTEMPT("scs byte", 0xE000ED00, 0, "1: ldrb r2, [r0]");
  ATTEMPT("in it block", 7, 0, "cmp r0, #7\n itt eq\n moveq r2, #1\n1: udiveq r2, r0, r1");
  ATTEMPT("after it", 7, 0, "cmp r0, #8\n it eq\n1: udiveq r2, r0, r1");
}

// A branch whose target cannot be executed: the return address is the target's.
static void jump(const char* what, uint32_t target) {
  fault.count = 0;
  __asm volatile("ldr r2, =1f\n str r2, %0\n bx %1\n .balign 2\n1:"
                 : "=m"(resume)
                 : "r"(target)
                 : "r2", "r3", "r12", "lr", "cc", "memory");
  show(what, target & ~1u);
}

static void everything(void) {
  attempts();
  jump("even address", 0x100);
  jump("even in device", 0x40000000);
  jump("even in system", 0xE0000000);
  jump("even nowhere", 0x60000000);
  jump("peripheral", 0x40000001);
  jump("system space", 0xE0000001);
  jump("no memory", 0x60000001);
}

int main(void) {
  volatile exception_handler* const vectors = take_vectors();
  for (int n = EXCEPTION_HARD_FAULT; n <= EXCEPTION_USAGE_FAULT; ++n) vectors[n] = handle_fault;
  ACTLR = ACTLR_DISDEFWBUF;
  SCB->CCR |= SCB_CCR_DIV_0_TRP_Msk | SCB_CCR_UNALIGN_TRP_Msk;
  SCB->SHCSR |= SHCSR_FAULTS;
  __DSB();
  __ISB();
  everything();
  puts("disabled: they escalate");
  SCB->SHCSR &= ~SHCSR_FAULTS;
  __DSB();
  everything();
  puts("without traps");
  SCB->SHCSR |= SHCSR_FAULTS;
  SCB->CCR &= ~(SCB_CCR_DIV_0_TRP_Msk | SCB_CCR_UNALIGN_TRP_Msk);
  __DSB();
  __ISB();
  attempts();
  return 0;
}
