// The pins of GPIO 0 and the buttons, printed whenever they change: the pins as a digit of seven
// segments on GPIO 1, too, and the lowest two on the LEDs. The second button ends it.
#include <stdint.h>
#include <stdio.h>

#include "an385.h"
#include "gpio.h"

#define FPGAIO_LED0 (*(volatile uint32_t*)0x40028000u)
#define FPGAIO_BUTTON (*(volatile uint32_t*)0x40028008u)

static const uint8_t digits[16] = {0x3F, 0x06, 0x5B, 0x4F, 0x66, 0x6D, 0x7D, 0x07,
                                   0x7F, 0x6F, 0x77, 0x7C, 0x39, 0x5E, 0x79, 0x71};

int main(void) {
  gpio_make_output(GPIO1, 0xFF);
  uint32_t before = ~0u, buttons = 0;
  while ((buttons & 2) == 0) {
    const uint32_t pins = gpio_read(GPIO0) & 0xF;
    buttons = FPGAIO_BUTTON;
    if ((pins | buttons << 4) == before) continue;
    before = pins | buttons << 4;
    GPIO1->DATAOUT = digits[pins];
    FPGAIO_LED0 = pins & 3;
    printf("pins %lx buttons %lx\n", (unsigned long)pins, (unsigned long)buttons);
  }
  return 0;
}
