// CMSDK APB timer: a 32-bit down counter that reloads at 0.
#ifndef CAPSOC_TIMER_H
#define CAPSOC_TIMER_H

#include <stdbool.h>
#include <stdint.h>

#include "an385.h"

// Counts `cycles` clock cycles (2 at least) again and again.
void timer_start(CMSDK_TIMER_Type* timer, uint32_t cycles, bool with_interrupt);
void timer_stop(CMSDK_TIMER_Type* timer);
uint32_t timer_value(const CMSDK_TIMER_Type* timer);
// True once after each period that was counted with the interrupt enabled.
bool timer_expired(CMSDK_TIMER_Type* timer);

#endif
