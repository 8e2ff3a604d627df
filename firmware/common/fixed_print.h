// Text output of integers and fixed-point numbers, in integer arithmetic alone. Everything goes to
// the console; decimals are rounded half away from zero.
#ifndef CAPSOC_FIXED_PRINT_H
#define CAPSOC_FIXED_PRINT_H

#include <stdint.h>

void print_text(const char* text);
// Right-justified in `width` characters; 0: as long as it is.
void print_unsigned(uint64_t value, unsigned width);
void print_signed(int64_t value, unsigned width);
// value * 2^-fraction_bits with `digits` decimals; fraction_bits <= 60, digits <= 18.
void print_fixed(int64_t value, unsigned fraction_bits, unsigned digits, unsigned width);
// A signed Q1.31 fraction with 9 decimals.
void print_q31(int32_t value, unsigned width);
// An angle in 2^-32 turn as radians in [-pi, pi) with 9 decimals.
void print_radians(uint32_t angle, unsigned width);
// The same as degrees in [0, 360) with 9 decimals.
void print_degrees(uint32_t angle, unsigned width);

#endif
