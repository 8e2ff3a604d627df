// Division of 64-bit numbers by libgcc, with and without sign, by small and large divisors.
#include "bench.h"

enum { rounds = 1500000 };

int main(void) {
  uint32_t seed = 8, hash = 0;
  for (uint32_t round = 0; round < rounds; ++round) {
    const uint64_t high = next_random(&seed), number = high << 32 | next_random(&seed);
    const uint64_t divisor = (next_random(&seed) >> (round & 31)) | 1;
    const uint64_t large = divisor << (round & 15);
    hash = hash * 31 + (uint32_t)(number / divisor) + (uint32_t)(number % large);
    hash ^= (uint32_t)((int64_t)number / -(int64_t)(divisor + round));
  }
  return report("long_division", hash);
}
