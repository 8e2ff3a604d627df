// A read of an address where nothing answers: first probed with care, then plainly, which is a
// precise BusFault, escalated, lockup.
#include <stdint.h>

#include "bus_probe.h"
#include "fixed_print.h"

enum { nowhere = 0x60000000 };

int main(void) {
  uint32_t value = 0;
  if (bus_probe(nowhere, &value)) {
    print_text("badread: the probe found something\n");
    return 1;
  }
  print_text("badread: reading\n");
  value = *(volatile const uint32_t*)nowhere;
  print_text("badread: still here\n");
  return value != 0 ? 1 : 2;
}
