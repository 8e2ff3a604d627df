// What a program may expect of the C library on this board: formatted output with floating point,
// sorting, the heap, 64-bit division, parsing, jumps out of a call.
#include <math.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool check(const char* what, bool passed) {
  printf("%-10s %s\n", what, passed ? "ok" : "FAILED");
  return passed;
}

static int ascending(const void* left, const void* right) {
  const uint32_t a = *(const uint32_t*)left;
  const uint32_t b = *(const uint32_t*)right;
  return (a > b) - (a < b);
}

static bool prints(void) {
  volatile double pi = 3.14159265358979;
  char text[64];
  snprintf(text, sizeof text, "%g %.9f %lld %08lx", pi, pi, (long long)INT64_MIN, 0xC0FFEEul);
  printf("%s\n", text);
  return strcmp(text, "3.14159 3.141592654 -9223372036854775808 00c0ffee") == 0;
}

static bool sorts(void) {
  enum { count = 1000 };
  static uint32_t words[count];
  uint32_t word = 1;
  for (unsigned i = 0; i < count; ++i) words[i] = word = word * 1664525u + 1013904223u;
  qsort(words, count, sizeof words[0], ascending);
  for (unsigned i = 1; i < count; ++i)
    if (words[i - 1] > words[i]) return false;
  return true;
}

static bool allocates(void) {
  enum { size = 1 << 20 };
  unsigned char* const block = malloc(size);
  if (block == NULL) return false;
  memset(block, 0x5A, size);
  unsigned char* const grown = realloc(block, 2 * size);
  const bool kept = grown != NULL && grown[0] == 0x5A && grown[size - 1] == 0x5A;
  free(grown);
  void* const too_much = malloc((size_t)64 << 20);  // more than the SRAM
  const bool refused = too_much == NULL;
  free(too_much);
  return kept && refused;
}

static bool divides(void) {
  volatile uint64_t dividend = UINT64_C(0xFEDCBA9876543210);
  volatile uint64_t divisor = 1000000007;
  volatile int64_t negative = INT64_C(-1234567890123456789);
  return dividend / divisor == UINT64_C(18364758415) && dividend % divisor == UINT64_C(939755815) &&
         negative / 1000 == INT64_C(-1234567890123456) && negative % 1000 == -789;
}

static bool computes(void) {
  volatile double angle = 0.5;
  return fabs(sin(angle) * sin(angle) + cos(angle) * cos(angle) - 1.0) < 1e-15;
}

static bool parses(void) {
  long number = 0;
  double fraction = 0;
  char word[8];
  const int found = sscanf("-1234 6.25e-3 seven", "%ld %lf %7s", &number, &fraction, word);
  char* end = NULL;
  const unsigned long hex = strtoul("0xfeedBEEFg", &end, 0);
  return found == 3 && number == -1234 && fraction == 0.00625 && strcmp(word, "seven") == 0 &&
         hex == 0xFEEDBEEFul && *end == 'g';
}

static jmp_buf back;

static void dive(unsigned depth) {
  volatile unsigned char weight[64];
  weight[0] = (unsigned char)depth;
  if (depth == 0) longjmp(back, 42);
  if (depth <= 20) dive(depth - 1);
  weight[1] = weight[0];
}

static bool jumps(void) {
  volatile unsigned turns = 0;
  const int status = setjmp(back);
  if (++turns == 1) dive(20);
  return status == 42 && turns == 2;
}

int main(void) {
  bool passed = check("printf", prints());
  passed &= check("qsort", sorts());
  passed &= check("malloc", allocates());
  passed &= check("division", divides());
  passed &= check("libm", computes());
  passed &= check("scanf", parses());
  passed &= check("longjmp", jumps());
  return passed ? 0 : 1;
}
