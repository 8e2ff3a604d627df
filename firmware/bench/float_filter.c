// A filter of 32 coefficients over noise, with a level, a division and a square root a sample.
#include "bench.h"

enum { taps = 32, samples = 4096, rounds = 300 };

static float coefficients[taps], input[samples + taps], output[samples];

// The instruction; sqrtf() sets errno.
static inline float square_root(float x) {
  float root;
  __asm__("vsqrt.f32 %0, %1" : "=t"(root) : "t"(x));
  return root;
}

int main(void) {
  uint32_t seed = 5, sum = 0;
  for (int i = 0; i < taps; ++i)
    coefficients[i] = (float)(next_random(&seed) & 0xFFFF) / 65536.0f - 0.5f;
  for (int i = 0; i < samples + taps; ++i)
    input[i] = (float)(int32_t)next_random(&seed) / 2147483648.0f;
  float level = 1;
  for (int round = 0; round < rounds; ++round) {
    for (int i = 0; i < samples; ++i) {
      float filtered = 0;
      for (int tap = 0; tap < taps; ++tap) filtered += coefficients[tap] * input[i + tap];
      if (filtered < 0) filtered = -filtered;
      level = 0.99f * level + 0.01f * filtered;
      output[i] = filtered / (1.0f + level) + square_root(filtered);
    }
    sum = sum * 33 + bits_of(level);
    for (int i = 0; i < samples; ++i) input[i] = output[i] - 0.5f;
  }
  return report("float_filter", sum);
}
