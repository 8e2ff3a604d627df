// Heap sort and a check by binary search: comparisons whose outcome nothing predicts.
#include "bench.h"

enum { count = 2048, rounds = 1500 };

static uint32_t values[count];

static void sift_down(uint32_t root, uint32_t end) {
  const uint32_t moved = values[root];
  for (uint32_t child; (child = 2 * root + 1) < end; root = child) {
    if (child + 1 < end && values[child] < values[child + 1]) ++child;
    if (moved >= values[child]) break;
    values[root] = values[child];
  }
  values[root] = moved;
}

static void heap_sort(void) {
  for (uint32_t i = count / 2; i-- > 0;) sift_down(i, count);
  for (uint32_t end = count; --end > 0;) {
    const uint32_t largest = values[0];
    values[0] = values[end];
    values[end] = largest;
    sift_down(0, end);
  }
}

static uint32_t position(uint32_t key) {
  uint32_t low = 0, high = count;
  while (low < high) {
    const uint32_t middle = (low + high) / 2;
    if (values[middle] < key) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

int main(void) {
  uint32_t seed = 5, sum = 0;
  for (uint32_t round = 0; round < rounds; ++round) {
    for (uint32_t i = 0; i < count; ++i) values[i] = next_random(&seed);
    heap_sort();
    for (uint32_t i = 0; i < count; ++i) sum = sum * 31 + position(next_random(&seed));
  }
  return report("sort", sum);
}
