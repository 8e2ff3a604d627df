// The channels of a coprocessor that serves several sensors (docs/reference/coprocessor.md,
// "Channels"). The functions of coprocessor.h act on the channel whose window is open. While one is
// open, samples of the others wait: close it before the next but one is due.
#ifndef CAPSOC_COPROCESSOR_CHANNELS_H
#define CAPSOC_COPROCESSOR_CHANNELS_H

#include <stdint.h>

// 1 to 16.
uint32_t coprocessor_channel_count(void);
// Waits until the registers are those of `channel`, some microseconds, and keeps them so. Returns
// what coprocessor_channel_restore() takes. Not to be called with one channel.
uint32_t coprocessor_channel_open(uint32_t channel);
// Samples choose the channel from here on.
void coprocessor_channel_close(void);
// The window as it was before an open, for an interrupt handler that opens another.
void coprocessor_channel_restore(uint32_t before);
// A bit for each channel that raises the interrupt.
uint32_t coprocessor_channels_pending(void);

#endif
