#include "gpio.h"

void gpio_make_output(CMSDK_GPIO_Type* port, uint32_t pins) {
  port->OUTENSET = pins;
}

void gpio_make_input(CMSDK_GPIO_Type* port, uint32_t pins) {
  port->OUTENCLR = pins;
}

void gpio_write(CMSDK_GPIO_Type* port, uint32_t pins, uint32_t level) {
  port->MASKLOWBYTE[pins & 0xFFu] = level & 0xFFu;
  port->MASKHIGHBYTE[(pins >> 8) & 0xFFu] = level & 0xFF00u;
}

uint32_t gpio_read(const CMSDK_GPIO_Type* port) {
  return port->DATA;
}
