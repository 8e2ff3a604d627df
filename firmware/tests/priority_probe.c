// What FreeRTOS does before it starts its scheduler, configured for the 8 priority bits of QEMU's
// board: it finds out how many there are, and goes no further if they are not as many.
#include <stdint.h>

#include "core_cm3.h"
#include "fixed_print.h"

enum { configured_bits = 8 };

int main(void) {
  const uint8_t original = NVIC->IPR[0];
  NVIC->IPR[0] = 0xFF;
  const uint32_t implemented = NVIC->IPR[0];
  NVIC->IPR[0] = original;
  if (implemented != (0xFF00u >> configured_bits & 0xFFu)) {
    print_text("priority_probe: assertion failed\n");
    __disable_irq();
    for (;;) {
    }
  }
  print_text("priority_probe: 8 bits\n");
  return 0;
}
