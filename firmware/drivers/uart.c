#include "uart.h"

void uart_open(CMSDK_UART_Type* uart, uint32_t clock_hz, uint32_t baud) {
  const uint32_t divider = (clock_hz + baud / 2) / baud;
  uart->CTRL = 0;
  uart->BAUDDIV = divider < 16 ? 16 : divider;
  uart->CTRL = CMSDK_UART_CTRL_TXEN_Msk | CMSDK_UART_CTRL_RXEN_Msk;
}

bool uart_can_send(const CMSDK_UART_Type* uart) {
  return (uart->STATE & CMSDK_UART_STATE_TXFULL_Msk) == 0;
}

void uart_write(CMSDK_UART_Type* uart, const char* text, size_t length) {
  for (size_t i = 0; i < length; ++i) {
    while (!uart_can_send(uart)) {
    }
    uart->DATA = (uint8_t)text[i];
  }
}

int uart_read(CMSDK_UART_Type* uart) {
  if ((uart->STATE & CMSDK_UART_STATE_RXFULL_Msk) == 0) return -1;
  return (int)(uart->DATA & 0xFFu);
}

void uart_flush(CMSDK_UART_Type* uart) {
  while (!uart_can_send(uart)) {
  }
  // The buffer is empty, but nothing tells when the shift register is: wait for the ten bits of a
  // frame and one more. A turn of the loop takes two cycles at least.
  for (uint32_t turns = 11 * uart->BAUDDIV / 2; turns != 0; --turns) __asm volatile("");
}
