// Products of matrices of single-precision numbers: loads and fused multiply-add in three loops.
#include "bench.h"

enum { size = 48, rounds = 600 };

static float a[size][size], b[size][size], product[size][size];

static void multiply(void) {
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      float sum = 0;
      for (int k = 0; k < size; ++k) sum += a[i][k] * b[k][j];
      product[i][j] = sum;
    }
  }
}

int main(void) {
  uint32_t seed = 2, sum = 0;
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      a[i][j] = (float)(next_random(&seed) & 0x3FF) / 7.0f;
      b[i][j] = (float)(next_random(&seed) & 0x3FF) / 3.0f;
    }
  }
  for (uint32_t round = 0; round < rounds; ++round) {
    multiply();
    for (int i = 0; i < size; ++i) {
      sum = sum * 33 + bits_of(product[i][i]);
      a[i][round % size] = (float)(sum & 0x3FF);
    }
  }
  return report("float_matrix", sum);
}
