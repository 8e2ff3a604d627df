// SYS_WRITE0 of a text of 30,000 bytes, by one call.
#include <stdint.h>

int main(void) {
  static char text[30001];
  for (unsigned i = 0; i < sizeof text - 1; ++i)
    text[i] = i % 50 == 49 ? '\n' : (char)('a' + i % 26);
  register uint32_t operation __asm("r0") = 4;
  register const void* argument __asm("r1") = text;
  __asm volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
  return 0;
}
