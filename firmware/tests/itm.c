// Text through the processor's Instrumentation Trace Macrocell, and one UNPREDICTABLE instruction,
// ten times.
#include <stdint.h>

#include "core_cm3.h"

#define ITM_PORT8(n) (*(volatile uint8_t*)(0xE0000000u + 4u * (n)))
#define ITM_PORT32(n) (*(volatile uint32_t*)(0xE0000000u + 4u * (n)))
#define ITM_TER (*(volatile uint32_t*)0xE0000E00u)
#define ITM_TCR (*(volatile uint32_t*)0xE0000E80u)
#define ITM_LAR (*(volatile uint32_t*)0xE0000FB0u)
#define ITM_UNLOCK 0xC5ACCE55u

static void put(char c) {
  while (ITM_PORT32(0) == 0) {
  }
  ITM_PORT8(0) = (uint8_t)c;
}

int main(void) {
  CoreDebug->DEMCR |= CoreDebug_DEMCR_TRCENA_Msk;
  ITM_LAR = ITM_UNLOCK;
  ITM_TER = 1;
  ITM_TCR = 1;
  for (const char* text = "itm: 42\n"; *text != 0; ++text) put(*text);
  for (int i = 0; i < 10; ++i)
    __asm volatile(".inst.w 0xf3600080" : : : "memory");  // BFI r0, r0 with its msb below its lsb
  return 0;
}
