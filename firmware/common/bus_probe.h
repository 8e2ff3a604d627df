// A careful look at an address that may not exist.
#ifndef CAPSOC_BUS_PROBE_H
#define CAPSOC_BUS_PROBE_H

#include <stdbool.h>
#include <stdint.h>

// Reads the word at `address` into `*value`. False, with `*value` untouched, if the bus answers
// with an error. Not to be called from a handler of BusFault's priority or above.
bool bus_probe(uint32_t address, uint32_t* value);

#endif
