// Copies, compares, measures and searches text with the C library: byte loads and short calls.
#include <string.h>

#include "bench.h"

enum { words = 512, longest = 15, rounds = 1500 };

static char dictionary[words][longest + 1];
static char page[words * (longest + 1) + 1];

int main(void) {
  uint32_t seed = 6, sum = 0;
  for (int i = 0; i < words; ++i) {
    const uint32_t length = 2 + next_random(&seed) % (longest - 2);
    for (uint32_t k = 0; k < length; ++k) {
      dictionary[i][k] = (char)('a' + next_random(&seed) % 6);
    }
  }
  for (uint32_t round = 0; round < rounds; ++round) {
    char* end = page;
    for (int i = 0; i < words; ++i) {
      const char* word = dictionary[next_random(&seed) % words];
      const size_t length = strlen(word);
      memcpy(end, word, length);
      end += length;
      *end++ = ' ';
    }
    *end = 0;
    for (int i = 0; i < 24; ++i) {
      const char* word = dictionary[next_random(&seed) % words];
      const char* found = strstr(page, word);
      sum = sum * 31 + (found != NULL ? (uint32_t)(found - page) : 0);
      for (int k = 0; k < words; k += 4) sum += strcmp(word, dictionary[k]) > 0;
    }
    for (char* p = page; (p = strchr(p, ' ')) != NULL; ++p) *p = '.';
    sum = sum * 31 + (uint8_t)page[next_random(&seed) % (uint32_t)(end - page)];
  }
  return report("strings", sum);
}
