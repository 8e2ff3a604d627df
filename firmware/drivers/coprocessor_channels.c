#include "coprocessor_channels.h"

#include "capsoc_device.h"

// The first version of the register map with CHANNEL.
enum { version_with_channels = COPROCESSOR_VERSION_Reset + 1 };

uint32_t coprocessor_channel_count(void) {
  if (COPROCESSOR->VERSION < version_with_channels) return 1;
  return ((COPROCESSOR_CHANNEL & COPROCESSOR_CHANNEL_LAST_Msk) >> COPROCESSOR_CHANNEL_LAST_Pos) + 1;
}

static void wait_until_ready(void) {
  while ((COPROCESSOR_CHANNEL & COPROCESSOR_CHANNEL_READY_Msk) == 0) {
  }
}

uint32_t coprocessor_channel_open(uint32_t channel) {
  const uint32_t before = COPROCESSOR_CHANNEL;
  COPROCESSOR_CHANNEL = channel | COPROCESSOR_CHANNEL_HOLD_Msk;
  wait_until_ready();
  return before;
}

void coprocessor_channel_close(void) {
  COPROCESSOR_CHANNEL = 0;
}

void coprocessor_channel_restore(uint32_t before) {
  COPROCESSOR_CHANNEL = before & (COPROCESSOR_CHANNEL_WINDOW_Msk | COPROCESSOR_CHANNEL_HOLD_Msk);
  if ((before & COPROCESSOR_CHANNEL_HOLD_Msk) != 0) wait_until_ready();
}

uint32_t coprocessor_channels_pending(void) {
  return (COPROCESSOR_CHANNEL & COPROCESSOR_CHANNEL_PENDING_Msk) >> COPROCESSOR_CHANNEL_PENDING_Pos;
}
