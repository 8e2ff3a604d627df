// Waiting without turning.
#ifndef CAPSOC_SLEEP_H
#define CAPSOC_SLEEP_H

#include <stdint.h>

// Sleeps until `*flag_or_count` is no longer `seen`. The test and the WFI are one unit: WFI wakes
// for a pending interrupt though PRIMASK holds it back, so none is slept through.
void sleep_while_equal(const volatile uint32_t* flag_or_count, uint32_t seen);

#endif
