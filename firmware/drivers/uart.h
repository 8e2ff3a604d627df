// CMSDK UART, polled: 8 data bits, no parity, one stop bit.
#ifndef CAPSOC_UART_H
#define CAPSOC_UART_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "an385.h"

// Enables transmitter and receiver. The divider is rounded to the nearest and is 16 at least.
void uart_open(CMSDK_UART_Type* uart, uint32_t clock_hz, uint32_t baud);
bool uart_can_send(const CMSDK_UART_Type* uart);
void uart_write(CMSDK_UART_Type* uart, const char* text, size_t length);
// The next character, or -1 if none has arrived.
int uart_read(CMSDK_UART_Type* uart);
// Returns when the last stop bit has left.
void uart_flush(CMSDK_UART_Type* uart);

#endif
