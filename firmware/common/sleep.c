#include "sleep.h"

#include "an385.h"

void sleep_while_equal(const volatile uint32_t* flag_or_count, uint32_t seen) {
  while (*flag_or_count == seen) {
    __disable_irq();
    if (*flag_or_count == seen) __WFI();
    __enable_irq();
    __ISB();  // the handler runs here
  }
}
