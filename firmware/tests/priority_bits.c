// How many bits a priority has, by what its registers read back, and what they decide: BASEPRI, and
// which interrupts preempt one another for each PRIGROUP (B1.5.4). Written for 8 bits, as programs
// for QEMU's board are: status 1 if there are fewer.
#include <stdio.h>

#include "core_cm3.h"
#include "handlers.h"

enum { low = EXCEPTION_IRQ0, high };  // interrupts 0 and 1; 1 is pended inside 0's handler

static volatile uint32_t order, preempted;

static void pend(int exception) {
  NVIC->ISPR[0] = 1u << (exception - EXCEPTION_IRQ0);
  __DSB();
  __ISB();
}

static void low_handler(void) {
  pend(high);
  order = order * 10 + 1;
}
static void high_handler(void) {
  preempted = order == 0;
  order = order * 10 + 2;
}

static unsigned bits_of(uint32_t ones) {
  unsigned bits = 0;
  for (; (ones & 0x80) != 0; ones <<= 1) ++bits;
  return bits;
}

static void set_basepri(uint32_t value) {
  __asm volatile("msr basepri, %0\n isb" ::"r"(value) : "memory");
}
static void set_basepri_max(uint32_t value) {
  __asm volatile("msr basepri_max, %0\n isb" ::"r"(value) : "memory");
}
static uint32_t basepri(void) {
  uint32_t value;
  __asm volatile("mrs %0, basepri" : "=r"(value));
  return value;
}

static void set_group(uint32_t group) {
  SCB->AIRCR = 0x05FA0000u | group << 8;
  __DSB();
}

// Whether the priority `a` preempts `b`.
static uint32_t preempts(uint32_t a, uint32_t b) {
  NVIC->IPR[0] = (uint8_t)b;
  NVIC->IPR[1] = (uint8_t)a;
  order = preempted = 0;
  pend(low);
  return preempted;
}

static unsigned read_back(void) {
  volatile uint32_t* const ipr = (volatile uint32_t*)0xE000E400u;
  volatile uint32_t* const shpr = (volatile uint32_t*)0xE000ED18u;
  ipr[7] = 0xFFFFFFFFu;
  for (int i = 0; i < 3; ++i) shpr[i] = 0xFFFFFFFFu;
  set_basepri(0xFF);
  const unsigned bits = bits_of(basepri());
  printf("BASEPRI %02lx: %u bits\n", (unsigned long)basepri(), bits);
  set_basepri(0);
  printf("IPR7 %08lx SHPR %08lx %08lx %08lx\n", (unsigned long)ipr[7], (unsigned long)shpr[0],
         (unsigned long)shpr[1], (unsigned long)shpr[2]);
  for (int i = 0; i < 3; ++i) shpr[i] = 0;
  NVIC->IPR[30] = 0x5A;
  printf("a byte: %08lx\n", (unsigned long)ipr[7]);
  ipr[7] = 0;
  set_basepri(0x35);
  set_basepri_max(0x36);
  printf("BASEPRI_MAX %02lx", (unsigned long)basepri());
  set_basepri_max(0x12);
  printf(" %02lx\n", (unsigned long)basepri());
  set_basepri(0);
  return bits;
}

int main(void) {
  volatile exception_handler* const vectors = take_vectors();
  vectors[low] = low_handler;
  vectors[high] = high_handler;
  const unsigned bits = read_back();
  NVIC_EnableIRQ(0);
  NVIC_EnableIRQ(1);
  // Pairs that differ in one bit: the group's bits preempt, the others decide nothing here.
  for (uint32_t group = 0; group < 8; ++group) {
    set_group(group);
    printf("PRIGROUP %lu:", (unsigned long)(SCB->AIRCR >> 8 & 7));
    for (uint32_t bit = 0x80; bit != 0; bit >>= 1) printf(" %lu", (unsigned long)preempts(0, bit));
    printf("\n");
  }
  // A critical section as FreeRTOS makes it: priorities of 5 and below must wait.
  set_group(0);
  NVIC->IPR[0] = 6;
  set_basepri(5);
  order = 0;
  pend(low);
  printf("critical section: %s\n", order == 0 ? "waits" : "broken");
  set_basepri(0);
  return bits == 8 ? 0 : 1;
}
