#include "angle_report.h"

#include "capsoc_device.h"
#include "fixed_print.h"
#include "sampling.h"

void print_angle(uint32_t sample) {
  const uint32_t angle = COPROCESSOR->ANGLE;
  print_text("angle ");
  print_unsigned(sample, 0);
  print_text(" ");
  print_unsigned(angle, 10);
  print_degrees(angle, 15);
  print_text(" deg\n");
}

bool print_angles(struct judgement* judgement, uint32_t first, uint32_t count, uint32_t stride) {
  for (uint32_t sample = first + stride; sample <= first + count; sample += stride) {
    if (!judgement_until(judgement, sample)) return false;
    print_angle(sample);
  }
  return judgement_until(judgement, first + count);  // what is less than a stride
}

void print_end(uint32_t samples) {
  print_text("the signal ended after ");
  print_unsigned(samples, 0);
  print_text(" samples\n");
}
