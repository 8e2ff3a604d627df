#include "system.h"

#include "clock.h"
#include "console.h"

void system_init(void) {
  console_open(clock_frequency_hz(), 115200);
}
