// Standard output on UART0. Polled after reset, so that the text before a crash is complete; a
// program that sleeps between samples lets the transmit interrupt send it instead.
#ifndef CAPSOC_CONSOLE_H
#define CAPSOC_CONSOLE_H

#include <stddef.h>
#include <stdint.h>

void console_open(uint32_t clock_hz, uint32_t baud);
// From here on console_write only fills a ring of 4 KiB (it sleeps while the ring is full) and must
// be called in thread mode with interrupts enabled.
void console_start_buffering(void);
void console_write(const char* text, size_t length);
// Returns when the last stop bit has left the UART.
void console_flush(void);

#endif
