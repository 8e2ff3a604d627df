// Asks questions on the semihosting console and says what was answered, and when: the processor
// does not see how long it took. Ends at the end of the input, or with "quit".
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "an385.h"
#include "handlers.h"

static int call(uint32_t number, const void* block) {
  register uint32_t operation __asm("r0") = number;
  register const void* argument __asm("r1") = block;
  __asm volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
  return (int)operation;
}

static volatile uint32_t ticks;

static void tick(void) {
  ++ticks;
}

static uint64_t now_ns(void) {
  uint64_t ns = 0;
  call(0x30, &ns);
  return ns;
}

int main(void) {
  take_vectors()[EXCEPTION_SYSTICK] = tick;
  SysTick->LOAD = 999;
  SysTick->VAL = 0;
  SysTick->CTRL = 7;
  const uint32_t open[3] = {(uint32_t) ":tt", 0, 3};
  const uint32_t handle = (uint32_t)call(0x01, open);
  static char text[24], said[96];
  unsigned count = 0;
  for (;;) {
    call(0x04, "line? ");
    memset(text, 0, sizeof text);
    const uint32_t read[3] = {handle, (uint32_t)text, sizeof text - 1};
    const int left = call(0x06, read);
    const int got = (int)sizeof text - 1 - left;
    text[strcspn(text, "\n")] = 0;
    snprintf(said, sizeof said, "%u: %d bytes \"%s\" after %u ticks, %u ns\n", ++count, got, text,
             (unsigned)ticks, (unsigned)now_ns());
    call(0x04, said);
    if (got == 0 || strcmp(text, "quit") == 0) break;
    call(0x04, "character? ");
    const int character = call(0x07, NULL);
    snprintf(said, sizeof said, "%u: character %d\n", count, character);
    call(0x04, said);
  }
  return 0;
}
