// Writes a line to UART 0 without asking whether there is room: QEMU's transmitter takes every byte
// at once, a real one has a shifter and one byte of buffer. Then a line as it should be.
#include "an385.h"
#include "fixed_print.h"
#include "uart.h"

int main(void) {
  for (const char* c = "lost in transmission\n"; *c != '\0'; ++c) UART0->DATA = (uint8_t)*c;
  uart_flush(UART0);
  print_text("overrun: done\n");
  return 0;
}
