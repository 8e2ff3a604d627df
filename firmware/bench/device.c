// Registers of devices, as a driver of a bus in software uses them: pins written, a timer's
// register read back. QEMU has no GPIO; its pins are not read.
#include "an385.h"
#include "bench.h"

enum { rounds = 400000 };

#define TIMER1_LOAD (*(volatile uint32_t*)0x40002000)

int main(void) {
  uint32_t seed = 3, sum = 0;
  TIMER1_LOAD = 0x1234;
  GPIO0->OUTENSET = 0xffff;
  for (int i = 0; i < rounds; ++i) {
    GPIO0->DATAOUT = next_random(&seed) & 0xffff;
    sum = sum * 31 + TIMER1_LOAD + (seed & 1);
  }
  return report("device", sum);
}
