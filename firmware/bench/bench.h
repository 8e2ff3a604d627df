// A kernel for `capsoc bench cpu`: work of a processor alone, a checksum on UART0 at the end. The
// same ELF runs on QEMU's mps2-an385 (mps2-an386 for a Cortex-M4), which must print the same line.
#ifndef CAPSOC_BENCH_H
#define CAPSOC_BENCH_H

#include <stdint.h>

#include "fixed_print.h"

// Marsaglia's xorshift: data that no compiler foresees and every run shares.
static inline uint32_t next_random(uint32_t* state) {
  uint32_t x = *state;
  x ^= x << 13;
  x ^= x >> 17;
  x ^= x << 5;
  return *state = x;
}

static inline uint32_t bits_of(float x) {
  union {
    float number;
    uint32_t bits;
  } both = {x};
  return both.bits;
}

// Prints "<name> <checksum in hexadecimal>"; the exit status of main.
static inline int report(const char* name, uint32_t checksum) {
  char text[12] = " 00000000\n";
  for (int i = 8; i >= 1; --i, checksum >>= 4) text[i] = "0123456789abcdef"[checksum & 15];
  print_text(name);
  print_text(text);
  return 0;
}

#endif
