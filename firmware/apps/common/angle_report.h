// Angles of the calibration mode as text, the same in all applications (tests and scripts read it).
#ifndef CAPSOC_ANGLE_REPORT_H
#define CAPSOC_ANGLE_REPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "judgement.h"

// "angle <sample> <word> <degrees> deg\n" of the newest result.
void print_angle(uint32_t sample);

// For `count` samples after sample `first`, which are judged: the angle of every `stride`-th. False
// if the signal ended before.
bool print_angles(struct judgement* judgement, uint32_t first, uint32_t count, uint32_t stride);

// "the signal ended after <samples> samples\n"
void print_end(uint32_t samples);

#endif
