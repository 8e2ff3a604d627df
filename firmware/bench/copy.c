// The C library's memcpy, memmove, memset and memcmp over short and long ranges at any alignment.
#include <string.h>

#include "bench.h"

enum { size = 4096, rounds = 300000 };

static uint8_t from[size + 64], to[size + 64];

int main(void) {
  uint32_t seed = 10, sum = 0;
  for (unsigned i = 0; i < sizeof from; ++i) from[i] = (uint8_t)next_random(&seed);
  for (uint32_t round = 0; round < rounds; ++round) {
    const uint32_t drawn = next_random(&seed);
    const uint32_t length = (drawn & 7) != 0 ? drawn >> 8 & 63 : drawn >> 8 & (size - 1);
    uint8_t* const there = to + (drawn >> 20 & 31);
    const uint8_t* const here = from + (drawn >> 25 & 31);
    memcpy(there, here, length);
    sum += (uint32_t)(memcmp(there, here, length) != 0) + there[length / 2];
    memmove(there + 3, there, length / 2);
    memset(to, (int)(drawn & 255), length & 31);
  }
  for (unsigned i = 0; i < sizeof to; ++i) sum = sum * 31 + to[i];
  return report("copy", sum);
}
