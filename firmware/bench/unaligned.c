// Copies between addresses that are no multiple of four, as packets have them.
#include <string.h>

#include "bench.h"

enum { rounds = 3000, size = 1024 };

static uint8_t from[size + 16], to[size + 16];

int main(void) {
  uint32_t seed = 3, sum = 0;
  for (unsigned i = 0; i < sizeof from; ++i) from[i] = (uint8_t)next_random(&seed);
  for (int i = 0; i < rounds; ++i) {
    const uint8_t* source = from + 1 + i % 3;
    uint8_t* target = to + 1 + (i >> 2) % 3;
    for (unsigned at = 0; at < size; at += 4) {
      uint32_t word;
      memcpy(&word, source + at, 4);
      sum += word;
      memcpy(target + at, &word, 4);
    }
  }
  return report("unaligned", sum ^ to[17]);
}
