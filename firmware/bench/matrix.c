// Products of integer matrices: multiply-accumulate in three nested loops.
#include "bench.h"

enum { size = 48, rounds = 1200 };

static int16_t a[size][size], b[size][size];
static int32_t product[size][size];

static void multiply(void) {
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      int32_t sum = 0;
      for (int k = 0; k < size; ++k) sum += a[i][k] * b[k][j];
      product[i][j] = sum;
    }
  }
}

int main(void) {
  uint32_t seed = 2, sum = 0;
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      a[i][j] = (int16_t)(next_random(&seed) & 0x3FF);
      b[i][j] = (int16_t)(next_random(&seed) & 0x3FF);
    }
  }
  for (uint32_t round = 0; round < rounds; ++round) {
    multiply();
    for (int i = 0; i < size; ++i) {
      sum = sum * 33 + (uint32_t)product[i][i];
      a[i][round % size] = (int16_t)(sum & 0x3FF);
    }
  }
  return report("matrix", sum);
}
