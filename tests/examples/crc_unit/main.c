// The CRC unit at work: status 0 if the sum is right and the interrupt came.
#include "crc_unit_driver.h"
#include "fixed_print.h"

void IRQ25_Handler(void);

static volatile uint32_t interrupts;

void IRQ25_Handler(void) {
  interrupts = interrupts + 1;
  CRC_UNIT->COUNT = 0;  // lowers the line
}

int main(void) {
  static const uint32_t words[] = {0x34333231, 0x38373635};  // "12345678"
  NVIC_EnableIRQ(CRC_UNIT_IRQn);
  const uint32_t crc = crc_of_words(words, 2);
  print_text(crc == 0x9AE0DAAF ? "crc: right\n" : "crc: wrong\n");
  return crc == 0x9AE0DAAF && interrupts == 1 ? 0 : 1;
}
