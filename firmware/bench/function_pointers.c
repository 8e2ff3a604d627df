// Calls through a table whose order no predictor foresees: stages of a signal chain.
#include "bench.h"

enum { stages = 8, rounds = 7000000 };

typedef uint32_t (*stage)(uint32_t value, uint32_t round);

static uint32_t add(uint32_t value, uint32_t round) {
  return value + round;
}
static uint32_t mix(uint32_t value, uint32_t round) {
  return value ^ (round << 7 | round >> 25);
}
static uint32_t scale(uint32_t value, uint32_t round) {
  return value * (round | 1);
}
static uint32_t turn(uint32_t value, uint32_t round) {
  const unsigned by = round & 31;
  return value >> by | value << ((32 - by) & 31);
}
static uint32_t clip(uint32_t value, uint32_t round) {
  return value > round << 16 ? value - round : value;
}
static uint32_t fold(uint32_t value, uint32_t round) {
  return (value & 0xFFFF) * 40503u + (value >> 16) + round;
}
static uint32_t swap(uint32_t value, uint32_t round) {
  return __builtin_bswap32(value) + (round & 1);
}
static uint32_t keep(uint32_t value, uint32_t round) {
  (void)round;
  return value;
}

static stage volatile chain[stages] = {add, mix, scale, turn, clip, fold, swap, keep};

int main(void) {
  uint32_t seed = 9, value = 1;
  for (uint32_t round = 0; round < rounds; ++round) {
    const uint32_t which = next_random(&seed);
    value = chain[which % stages](value, round);
    value = chain[(which >> 8) % stages](value, round);
  }
  return report("function_pointers", value);
}
