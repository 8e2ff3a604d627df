// Output as a first program writes it: every byte waits in a loop for the transmitter, at 115,200
// baud. QEMU's transmitter is always ready.
#include "bench.h"
#include "clock.h"
#include "uart.h"

enum { lines = 500, length = 54 };

int main(void) {
  uint32_t seed = 11, sum = 0;
  uart_open(UART0, clock_frequency_hz(), 115200);
  for (int line = 0; line < lines; ++line) {
    char text[length];
    for (int n = 0; n < length - 1; ++n) {
      text[n] = (char)('a' + next_random(&seed) % 26);
      sum = sum * 31 + (uint8_t)text[n];
    }
    text[length - 1] = '\n';
    uart_write(UART0, text, length);
  }
  return report("polling", sum);
}
