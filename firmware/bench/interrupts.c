// A program for random interrupt schedules. Every line has a handler; handlers nest, pend each
// other, change priorities and masks. The thread runs unprivileged under the MPU on the process
// stack and works with IT blocks, exclusives, multiple transfers, divisions and SVCs. It never
// ends.
#include <stdint.h>

#include "core_cm3.h"

#define MPU_CTRL (*(volatile uint32_t*)0xE000ED94u)
#define MPU_RNR (*(volatile uint32_t*)0xE000ED98u)
#define MPU_RBAR (*(volatile uint32_t*)0xE000ED9Cu)
#define MPU_RASR (*(volatile uint32_t*)0xE000EDA0u)
#define STIR (*(volatile uint32_t*)0xE000EF00u)

enum { icsr_pendsv = 1 << 28, lines = 32 };

// What handlers and thread have seen, in order: any difference in time or order changes it.
volatile uint32_t history;
volatile uint32_t counter;
static uint32_t thread_stack[512] __attribute__((aligned(2048)));
static uint32_t shared[64] __attribute__((aligned(256)));
static uint32_t table[48] __attribute__((aligned(256)));

static uint32_t ipsr(void) {
  uint32_t value;
  __asm volatile("mrs %0, ipsr" : "=r"(value));
  return value;
}

static void note(uint32_t value) {
  history = history * 31 + value;
}

__attribute__((noinline)) static uint32_t work(uint32_t x) {
  uint32_t sum = 0;
  for (uint32_t i = 0; i < (x & 7) + 2; ++i) {
    sum += x / (i + 1) + (i & 1 ? x : ~x);
    shared[(x + i) & 63] ^= sum;
  }
  return sum;
}

__attribute__((noinline)) static uint32_t add_exclusive(volatile uint32_t* word) {
  uint32_t value, failed;
  do {
    __asm volatile("ldrex %0, [%1]" : "=r"(value) : "r"(word) : "memory");
    __asm volatile("strex %0, %1, [%2]" : "=&r"(failed) : "r"(value + 1), "r"(word) : "memory");
  } while (failed);
  return value + 1;
}

static void any_handler(void) {
  const uint32_t number = ipsr();
  note(number + DWT->CYCCNT);
  note(work(number ^ history));
  if (number % 3 == 0) {
    __asm volatile("msr basepri, %0" ::"r"(number << 4 & 0xE0) : "memory");
    note(work(history));
    __asm volatile("msr basepri, %0" ::"r"(0) : "memory");
  }
  if (number % 4 == 0) SCB->ICSR = icsr_pendsv;
  if (number % 5 == 0) STIR = history % lines;
  if (number % 7 == 0) NVIC->IPR[history % lines] = (uint8_t)(history >> 8);
  if (number % 11 == 0) {
    __disable_irq();
    note(add_exclusive(&counter));
    __enable_irq();
  }
  if (number % 13 == 0) NVIC->ICPR[0] = 1u << history % lines;
}

static void svc_handler(void) {
  note(SysTick->VAL);
  MPU_RNR = 7;  // opens and closes the upper half of the table to the thread
  MPU_RASR = MPU_RASR ^ 0xF000;
}

// Steps over the instruction that was refused, 2 or 4 bytes.
__attribute__((naked)) static void fault_handler(void) {
  __asm volatile(
      "mrs r0, psp\n"
      "ldr r1, [r0, #24]\n"
      "ldrh r2, [r1]\n"
      "lsrs r2, r2, #11\n"
      "cmp r2, #29\n"
      "ite cs\n"
      "addcs r1, #4\n"
      "addcc r1, #2\n"
      "str r1, [r0, #24]\n"
      "ldr r2, =history\n"
      "ldr r3, [r2]\n"
      "eor r3, r3, r1\n"
      "str r3, [r2]\n"
      "bx lr\n");
}

static void region(uint32_t number, uint32_t base, uint32_t rasr) {
  MPU_RNR = number;
  MPU_RBAR = base;
  MPU_RASR = rasr;
}

__attribute__((noinline)) static void move_block(uint32_t* to, const uint32_t* from) {
  __asm volatile(
      "ldmia %0!, {r4-r7}\n"
      "stmia %1!, {r4-r7}\n"
      : "+r"(from), "+r"(to)
      :
      : "r4", "r5", "r6", "r7", "memory");
}

static void thread(void) {
  uint32_t x = 1;
  for (;;) {
    x = x * 1664525 + 1013904223;
    x += work(x);
    move_block(&shared[x & 31], &shared[x >> 8 & 31]);
    add_exclusive(&shared[63]);
    if ((x & 15) == 0) __asm volatile("svc #1" ::: "memory");
    table[x % 48] = x;  // the MPU may refuse it
    x += table[x % 24];
    if ((x & 63) == 1) __WFI();
  }
}

typedef void (*handler)(void);
static handler vectors[48] __attribute__((aligned(256)));

int main(void) {
  for (int n = 1; n < 48; ++n) vectors[n] = any_handler;
  for (int n = 3; n <= 6; ++n) vectors[n] = fault_handler;
  vectors[11] = svc_handler;
  SCB->VTOR = (uint32_t)vectors;
  SCB->SHCSR = 7u << 16;
  SCB->CCR |= 2;                      // USERSETMPEND
  SCB->AIRCR = 0x05FA0000u | 5 << 8;  // two bits of group priority
  for (int n = 0; n < lines; ++n) NVIC->IPR[n] = (uint8_t)(n * 96 + 32);
  SCB->SHPR[10] = 0xE0;
  SCB->SHPR[11] = 0x80;
  NVIC->ISER[0] = ~0u;
  CoreDebug->DEMCR = CoreDebug_DEMCR_TRCENA_Msk;
  DWT->CTRL |= DWT_CTRL_CYCCNTENA_Msk;
  SysTick->LOAD = 1996;
  SysTick->CTRL = 7;
  region(0, 0, 0x06000000 | 21 << 1 | 1);                       // code: read only, 4 MiB
  region(1, (uint32_t)thread_stack, 0x13000000 | 10 << 1 | 1);  // 2 KiB, never executed
  region(2, (uint32_t)shared, 0x13000000 | 7 << 1 | 1);
  region(7, (uint32_t)table, 0x13000000 | 7 << 1 | 1);  // 256 bytes in eighths
  MPU_CTRL = 5;
  __asm volatile(
      "msr psp, %0\n"
      "msr control, %1\n"
      "isb\n" ::"r"(thread_stack + 512),
      "r"(3)
      : "memory");
  thread();
  return 0;
}
