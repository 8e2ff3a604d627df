#include "console.h"

#include <stdbool.h>

#include "an385.h"
#include "sleep.h"
#include "uart.h"

enum { ring_size = 4096 };

static char ring[ring_size];
static volatile uint32_t ring_sent;  // both count characters and wrap at 2^32
static volatile uint32_t ring_written;
static bool buffered;

void console_open(uint32_t clock_hz, uint32_t baud) {
  uart_open(UART0, clock_hz, baud);
  if (buffered) UART0->CTRL |= CMSDK_UART_CTRL_TXIRQEN_Msk;
}

void console_start_buffering(void) {
  buffered = true;
  UART0->INTSTATUS = CMSDK_UART_INT_TX_Msk;
  UART0->CTRL |= CMSDK_UART_CTRL_TXIRQEN_Msk;
  NVIC_EnableIRQ(UART0_TX_IRQn);
}

static void feed_transmitter(void) {
  while (ring_sent != ring_written && uart_can_send(UART0)) {
    UART0->DATA = (uint8_t)ring[ring_sent % ring_size];
    ++ring_sent;
  }
}

void UART0_TX_Handler(void) {
  UART0->INTSTATUS = CMSDK_UART_INT_TX_Msk;
  feed_transmitter();
}

void console_write(const char* text, size_t length) {
  if (!buffered) {
    uart_write(UART0, text, length);
    return;
  }
  for (size_t i = 0; i < length; ++i) {
    for (uint32_t sent = ring_sent; ring_written - sent == ring_size; sent = ring_sent)
      sleep_while_equal(&ring_sent, sent);
    ring[ring_written % ring_size] = text[i];
    ++ring_written;
  }
  // While characters are on their way the interrupt continues by itself; this starts it.
  __disable_irq();
  feed_transmitter();
  __enable_irq();
}

void console_flush(void) {
  for (uint32_t sent = ring_sent; sent != ring_written; sent = ring_sent)
    sleep_while_equal(&ring_sent, sent);
  uart_flush(UART0);
}
