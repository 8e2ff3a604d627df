// The memory protection unit (B3.5): what each access permission lets a program with and without
// privilege do, sub-regions, overlap, the background region, execute-never, a guard below a process
// stack. All of it is a matter of attempts that fault or do not.
#include <stdbool.h>
#include <stdio.h>

#include "core_cm3.h"
#include "handlers.h"

typedef struct {
  __I uint32_t TYPE;
  __IO uint32_t CTRL;
  __IO uint32_t RNR;
  __IO uint32_t RBAR;
  __IO uint32_t RASR;
} mpu_unit;
#define MPU ((mpu_unit*)0xE000ED90u)
#define MPU_ENABLE 1u
#define MPU_HFNMIENA 2u
#define MPU_PRIVDEFENA 4u
#define FULL_ACCESS (3u << 24)
#define READ_ONLY (6u << 24)
#define EXECUTE_NEVER (1u << 28)
#define SIZE(bits) (((bits)-1u) << 1)

// PSRAM, which no region of the program itself covers.
static uint32_t* const arena = (uint32_t*)0x21000000u;

__attribute__((used)) static volatile uint32_t resume, faults, cfsr, mmfar;

__attribute__((used)) static void note_fault(struct exception_frame* frame, uint32_t exc_return) {
  (void)exc_return;
  ++faults;
  cfsr = SCB->CFSR;
  mmfar = SCB->MMFAR;
  SCB->CFSR = cfsr;
  frame->pc = resume;
  frame->xpsr = (frame->xpsr & 0xF80003FFu) | 1u << 24;
}
HANDLER_WITH_FRAME(handle_fault, note_fault)

// Back to privilege; nothing else does without an exception.
__attribute__((naked)) static void handle_svc(void) {
  __asm volatile("mov r0, #0\n msr control, r0\n isb\n bx lr");
}

static void region(uint32_t number, const void* base, uint32_t attributes) {
  MPU->RNR = number;
  MPU->RBAR = (uint32_t)(uintptr_t)base;
  MPU->RASR = attributes;
}

static void enable(uint32_t control) {
  MPU->CTRL = control;
  __DSB();
  __ISB();
}

// True if the access goes through. `user`: made without privilege.
static bool attempt(const void* address, bool store, bool user) {
  faults = 0;
  __asm volatile(
      "ldr r2, =9f\n str r2, %0\n"
      "cmp %3, #0\n it ne\n msrne control, %3\n isb\n"
      "cmp %2, #0\n ite eq\n ldreq r0, [%1]\n strne r0, [%1]\n"
      "9: mrs r0, control\n tst r0, #1\n it ne\n svcne #0\n"
      : "=m"(resume)
      : "r"(address), "r"((uint32_t)store), "r"((uint32_t)user)
      : "r0", "r2", "r3", "r12", "lr", "cc", "memory");
  return faults == 0;
}

static char answer(const void* address, bool store, bool user) {
  return attempt(address, store, user) ? (store ? 'w' : 'r') : '-';
}

static void permissions(void) {
  for (uint32_t ap = 0; ap < 8; ++ap) {
    if (ap == 4) continue;  // reserved
    region(3, arena, ap << 24 | SIZE(12) | 1u);
    enable(MPU_ENABLE | MPU_PRIVDEFENA);
    const char answers[] = {answer(arena, false, false), answer(arena, true, false),
                            answer(arena, false, true), answer(arena, true, true), 0};
    enable(0);
    printf("AP %lu         %s\n", (unsigned long)ap, answers);
  }
}

static void shapes(void) {
  const char* const at = (const char*)arena;
  region(3, arena, FULL_ACCESS | SIZE(12) | 0x81u << 8 | 1u);  // without the first and last eighth
  enable(MPU_ENABLE | MPU_PRIVDEFENA);
  printf("sub-regions  ");
  for (unsigned eighth = 0; eighth < 8; ++eighth) putchar(answer(at + 512 * eighth, true, true));
  enable(0);
  region(3, arena, FULL_ACCESS | SIZE(12) | 1u);
  region(5, arena, READ_ONLY | SIZE(5) | 1u);  // 32 bytes, the higher number decides
  enable(MPU_ENABLE | MPU_PRIVDEFENA);
  printf("\noverlap      %c%c\n", answer(at + 28, true, true), answer(at + 32, true, true));
  attempt(at + 28, true, true);
  printf("status       cfsr %02lx mmfar %+ld\n", (unsigned long)cfsr,
         (long)(mmfar - (uint32_t)(uintptr_t)at));
  enable(0);
  region(5, arena, 0);
  region(3, arena, 0);
  enable(MPU_ENABLE | MPU_PRIVDEFENA);
  printf("background   %c%c\n", answer(at, true, false), answer(at, true, true));
  enable(0);
}

static void execution(void) {
  static const uint16_t returns[] = {0x4770, 0x4770};  // bx lr
  memcpy(arena, returns, sizeof returns);
  for (unsigned never = 0; never < 2; ++never) {
    region(3, arena, FULL_ACCESS | SIZE(12) | (never ? EXECUTE_NEVER : 0) | 1u);
    enable(MPU_ENABLE | MPU_PRIVDEFENA);
    faults = 0;
    __asm volatile("ldr r2, =8f\n str r2, %0\n blx %1\n8:"
                   : "=m"(resume)
                   : "r"((uint32_t)(uintptr_t)arena | 1u)
                   : "r0", "r1", "r2", "r3", "r12", "lr", "cc", "memory");
    printf("never %u      %lu %02lx\n", never, (unsigned long)faults,
           faults ? (unsigned long)cfsr : 0ul);
    enable(0);
  }
}

// Without HFNMIENA the unit is off while FAULTMASK is set.
static void faultmask(void) {
  region(3, arena, READ_ONLY | SIZE(12) | 1u);
  enable(MPU_ENABLE | MPU_PRIVDEFENA);
  __asm volatile("cpsid f" ::: "memory");
  arena[1] = 77;
  __asm volatile("cpsie f" ::: "memory");
  printf("faultmask    %lu\n", (unsigned long)arena[1]);
  enable(0);
}

int main(void) {
  volatile exception_handler* const vectors = take_vectors();
  vectors[EXCEPTION_MEM_MANAGE] = handle_fault;
  vectors[EXCEPTION_SVCALL] = handle_svc;
  SCB->SHCSR |= 1u << 16;
  // Code and data for everyone: the programs without privilege are this one.
  region(0, (const void*)0, READ_ONLY | SIZE(22) | 1u);
  region(1, (const void*)0x20000000, FULL_ACCESS | SIZE(22) | 1u);
  permissions();
  shapes();
  execution();
  faultmask();
  printf("type         %08lx\n", (unsigned long)MPU->TYPE);
  return 0;
}
