// Prints, and asks the coprocessor for an angle. newlib is there with printf, malloc and libm; the
// board's drivers are in drivers/, its registers in board/an385.h and board/capsoc_device.h.
#include <math.h>
#include <stdio.h>

#include "capsoc_device.h"
#include "coprocessor.h"

static double angle_of(double radians) {
  COPROCESSOR->CTRL = COPROCESSOR_CTRL_CALIB_Msk;
  // At the amplitude of the reset values, Q1.31.
  COPROCESSOR->SOFT_U = (uint32_t)(int32_t)(0x1p30 * sin(radians));
  COPROCESSOR->SOFT_V = (uint32_t)(int32_t)(0x1p30 * cos(radians));
  while (COPROCESSOR->STATUS & COPROCESSOR_STATUS_BUSY_Msk) {
  }
  return COPROCESSOR->ANGLE * 360.0 / 0x1p32;
}

int main(void) {
  printf("hello\n");
  if (!coprocessor_present()) {
    printf("no coprocessor\n");
    return 0;
  }
  printf("angle: %.4f degrees\n", angle_of(0.5235987756));
  return 0;
}
