// Counters that several threads may share: LDREX and STREX, interrupts masked, barriers.
#include "an385.h"
#include "bench.h"

enum { rounds = 400000 };

static volatile uint32_t counter, masked;

static uint32_t add_exclusive(volatile uint32_t* word, uint32_t step) {
  uint32_t value, failed;
  do {
    __asm volatile("ldrex %0, [%1]" : "=r"(value) : "r"(word) : "memory");
    value += step;
    __asm volatile("strex %0, %1, [%2]" : "=&r"(failed) : "r"(value), "r"(word) : "memory");
  } while (failed != 0);
  return value;
}

int main(void) {
  uint32_t seed = 3;
  for (int i = 0; i < rounds; ++i) {
    const uint32_t value = add_exclusive(&counter, next_random(&seed) & 7);
    uint32_t before;
    __asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(before) : : "memory");
    masked += value;
    __asm volatile("msr primask, %0\n\tdmb" : : "r"(before) : "memory");
  }
  return report("exclusives", counter * 31 + masked);
}
