// Says whether the coprocessor is there and what angle it finds in one sample.
#include <stdint.h>

#include "capsoc_device.h"

// CMSDK UART 0 of the board.
#define UART0_DATA (*(volatile uint32_t*)0x40004000u)
#define UART0_STATE (*(volatile uint32_t*)0x40004004u)
#define UART0_CTRL (*(volatile uint32_t*)0x40004008u)
#define UART0_BAUDDIV (*(volatile uint32_t*)0x40004010u)

static void print(const char* text) {
  for (; *text != 0; ++text) {
    while (UART0_STATE & 1) {  // the transmitter is full
    }
    UART0_DATA = (uint8_t)*text;
  }
}

static void print_number(uint32_t number) {
  if (number >= 10) print_number(number / 10);
  print((const char[]){(char)('0' + number % 10), 0});
}

int main(void) {
  UART0_BAUDDIV = 25000000 / 115200;
  UART0_CTRL = 1;
  if (COPROCESSOR->ID != COPROCESSOR_ID_Reset) {
    print("no coprocessor\n");
    return 1;
  }
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_CALIB_Msk;
  // U = sin, V = cos of 30 degrees, Q1.31, at the amplitude of the reset values.
  COPROCESSOR->SOFT_U = 0x20000000;
  COPROCESSOR->SOFT_V = 0x376CF5D1;
  while (COPROCESSOR->STATUS & COPROCESSOR_STATUS_BUSY_Msk) {
  }
  print("angle: ");
  print_number((uint32_t)(((uint64_t)COPROCESSOR->ANGLE * 3600 + 0x80000000u) >> 32));
  print(" tenths of a degree\n");
  return 0;
}
