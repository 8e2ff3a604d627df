// Threads and handlers that use the FPU at once: frames, saves that are made late, and a save that
// the MPU forbids. Prints the same on every Cortex-M4 with FPU.
#include <stdint.h>
#include <stdio.h>

#include "core_cm3.h"
#include "handlers.h"

#define FPCCR (*(volatile uint32_t*)0xE000EF34u)
#define FPCAR (*(volatile uint32_t*)0xE000EF38u)
#define MPU_REGISTERS ((volatile uint32_t*)0xE000ED90u)  // TYPE, CTRL, RNR, RBAR, RASR
#define FPDSCR (*(volatile uint32_t*)0xE000EF3Cu)
enum { lspact = 1, lspen = 1u << 30, singles = 32 };

struct registers {
  uint32_t s[singles], fpscr;
};

// Makes all the registers known, calls the supervisor, and says how many of them differ then.
__attribute__((noinline)) static unsigned differences_after_call(void) {
  struct registers before, after;
  for (unsigned n = 0; n < singles; ++n) before.s[n] = 0x3F800000u + 0x10001u * n;
  before.fpscr = 0xA3400011u;
  const struct registers* from = &before;
  struct registers* to = &after;
  __asm volatile(
      "vldmia %0!, {s0-s31}\n ldr r3, [%0]\n vmsr fpscr, r3\n svc #0\n"
      "vstmia %1!, {s0-s31}\n vmrs r3, fpscr\n str r3, [%1]\n"
      : "+r"(from), "+r"(to)
      :
      : "r3", "memory", "cc", "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9", "s10",
        "s11", "s12", "s13", "s14", "s15", "s16", "s17", "s18", "s19", "s20", "s21", "s22", "s23",
        "s24", "s25", "s26", "s27", "s28", "s29", "s30", "s31");
  unsigned differ = before.fpscr != after.fpscr;
  for (unsigned n = 0; n < singles; ++n) differ += before.s[n] != after.s[n];
  return differ;
}

static volatile uint32_t seen_return, seen_fpccr, seen_fpcar, seen_first, seen_mode;
static volatile int handler_computes;

// Uses the registers that a function may change; the others it has to keep.
__attribute__((noinline)) static float compute(float x) {
  float sum = 1;
  for (int i = 1; i < 8; ++i) sum = sum * x + (float)i / 3.0f;
  return sum;
}

__attribute__((used)) static void note_call(struct exception_frame* frame, uint32_t exc_return) {
  seen_return = exc_return;
  seen_fpccr = FPCCR & ~(1u << 10);  // which is of Armv8-M; QEMU has it
  seen_fpcar = (FPCAR - (uint32_t)(uintptr_t)frame) & 0xFFFu;
  if (!handler_computes) return;
  uint32_t fpscr;
  __asm volatile("vmrs %0, fpscr" : "=r"(fpscr));
  seen_mode = fpscr & 0x07C00000u;  // what FPDSCR has of it
  volatile float result = compute(1.5f);
  (void)result;
  seen_first = ((const uint32_t*)frame)[8];  // S0
}
HANDLER_WITH_FRAME(handle_call, note_call)

static void show(const char* what) {
  const unsigned differ = differences_after_call();
  printf("%-28s differ %u, EXC_RETURN %08lx, FPCCR %08lx, FPCAR +%lx, S0 %08lx, FPSCR %08lx\n",
         what, differ, (unsigned long)seen_return, (unsigned long)seen_fpccr,
         (unsigned long)seen_fpcar, (unsigned long)seen_first, (unsigned long)seen_mode);
  seen_first = seen_mode = 0;
}

// The save into a stack that has become read-only.
static volatile uint32_t forbidden_cfsr, forbidden_count, forbidden_lspact;
__attribute__((used)) static void note_forbidden(struct exception_frame* frame,
                                                 uint32_t exc_return) {
  (void)frame;
  (void)exc_return;
  ++forbidden_count;
  forbidden_cfsr = SCB->CFSR;
  forbidden_lspact = FPCCR & lspact;
  SCB->CFSR = forbidden_cfsr;
  MPU_REGISTERS[1] = 0;
  __DSB();
}
HANDLER_WITH_FRAME(handle_forbidden, note_forbidden)

__attribute__((used)) static void note_protected_call(struct exception_frame* frame,
                                                      uint32_t exc_return) {
  MPU_REGISTERS[2] = 0;
  MPU_REGISTERS[3] = ((uint32_t)(uintptr_t)frame + 0x20 + 31) & ~31u;
  MPU_REGISTERS[4] = 5u << 24 | 4u << 1 | 1;  // 32 bytes, read-only
  MPU_REGISTERS[1] = 5;
  __DSB();
  __ISB();
  note_call(frame, exc_return);
}
HANDLER_WITH_FRAME(handle_protected_call, note_protected_call)

// Interrupts of three priorities that all compute.
static volatile uint32_t ticks, switches;
static volatile float of_ticks, of_switches;
__attribute__((noinline)) static void tick(void) {
  of_ticks = compute((float)ticks * 0.001f);
  ++ticks;
  if (ticks % 2 == 0) SCB->ICSR = 1u << 28;  // PendSV
}
static void switch_handler(void) {
  const float x = (float)switches * 0.25f;
  of_switches = compute(x) + compute(x + 1);
  ++switches;
}

static uint32_t checksum(uint32_t rounds) {
  float x = 0.5f, y = 0.25f;
  uint32_t hash = 2166136261u;
  for (uint32_t i = 0; i < rounds; ++i) {
    x = 3.7f * x * (1 - x);
    y = (x + y) / 1.25f;
    union {
      float number;
      uint32_t bits;
    } mixed = {x + y};
    hash = (hash ^ mixed.bits) * 16777619u;
  }
  return hash;
}

int main(void) {
  volatile exception_handler* const vectors = take_vectors();
  vectors[EXCEPTION_SVCALL] = handle_call;
  vectors[EXCEPTION_MEM_MANAGE] = handle_forbidden;
  FPDSCR = 2u << 22;
  show("handler without FPU");
  handler_computes = 1;
  show("handler with FPU");
  SCB->SHCSR = 7u << 16;
  show("faults enabled");
  FPCCR &= ~(uint32_t)lspen;
  show("without LSPEN");
  handler_computes = 0;
  show("without LSPEN and FPU");
  FPCCR |= lspen;
  handler_computes = 1;
  SCB->SHPR[7] = 0x80;  // SVCall below MemManage
  vectors[EXCEPTION_SVCALL] = handle_protected_call;
  show("a save that is forbidden");
  printf("MemManage %lu, CFSR %08lx, LSPACT %lu\n", (unsigned long)forbidden_count,
         (unsigned long)forbidden_cfsr, (unsigned long)forbidden_lspact);

  const uint32_t alone = checksum(20000);
  vectors[EXCEPTION_SYSTICK] = tick;
  vectors[EXCEPTION_PENDSV] = switch_handler;
  SCB->SHPR[10] = 0xE0;  // PendSV below SysTick
  SysTick->LOAD = 700;
  SysTick->VAL = 0;
  SysTick->CTRL = 7;
  unsigned wrong = 0;
  do {
    wrong += checksum(20000) != alone;
  } while (ticks < 200);
  SysTick->CTRL = 0;
  printf("interrupted checksums that differ: %u\n", wrong);
  return 0;
}
