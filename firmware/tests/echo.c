// Sends back what UART 0 receives, at the fastest baud rate: first the number of bytes (four bytes,
// little end first, sent back, too), then that many. It sleeps between bytes.
#include <stdint.h>

#include "an385.h"
#include "uart.h"

enum { fastest_divider = 16 };

// The interrupt wakes the processor and is never taken.
static uint8_t receive(void) {
  while ((UART0->STATE & CMSDK_UART_STATE_RXFULL_Msk) == 0) {
    __WFI();
    UART0->INTSTATUS = CMSDK_UART_INT_RX_Msk;
    NVIC_ClearPendingIRQ(UART0_RX_IRQn);
  }
  return (uint8_t)UART0->DATA;
}

static uint8_t echo(void) {
  const uint8_t byte = receive();
  while (!uart_can_send(UART0)) {
  }
  UART0->DATA = byte;
  return byte;
}

int main(void) {
  __disable_irq();
  UART0->BAUDDIV = fastest_divider;
  UART0->CTRL = CMSDK_UART_CTRL_TXEN_Msk | CMSDK_UART_CTRL_RXEN_Msk | CMSDK_UART_CTRL_RXIRQEN_Msk;
  NVIC_EnableIRQ(UART0_RX_IRQn);
  uint32_t count = 0;
  for (unsigned i = 0; i < 4; ++i) count |= (uint32_t)echo() << (8 * i);
  while (count-- != 0) echo();
  uart_flush(UART0);
  return 0;
}
