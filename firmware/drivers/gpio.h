// CMSDK AHB GPIO, 16 pins a port.
#ifndef CAPSOC_GPIO_H
#define CAPSOC_GPIO_H

#include <stdint.h>

#include "an385.h"

// Every argument `pins` is a mask of pins 0 to 15.
void gpio_make_output(CMSDK_GPIO_Type* port, uint32_t pins);
void gpio_make_input(CMSDK_GPIO_Type* port, uint32_t pins);
// Drives `pins` to the bits of `level`; the other pins keep theirs, without a read between.
void gpio_write(CMSDK_GPIO_Type* port, uint32_t pins, uint32_t level);
uint32_t gpio_read(const CMSDK_GPIO_Type* port);

#endif
