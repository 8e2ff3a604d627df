// Floating point without an FPU: libgcc's additions, products, quotients and conversions in both
// precisions, on a map that never settles.
#include "bench.h"

enum { rounds = 350000 };

int main(void) {
  double x = 0.3, sum = 0;
  float y = 0.7f;
  uint32_t hash = 0;
  for (uint32_t round = 1; round <= rounds; ++round) {
    x = 3.9 * x * (1.0 - x);
    y = 3.8f * y * (1.0f - y);
    sum += x / (1.0 + (double)y);
    if (x > 0.5 && y < 0.9f) hash += (uint32_t)(x * 4294967295.0);
    hash ^= (uint32_t)(int32_t)(y * 1e6f) + round;
  }
  return report("soft_float", hash ^ (uint32_t)(sum * 1000.0));
}
