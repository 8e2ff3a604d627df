#include "fixed_print.h"

#include <stdbool.h>
#include <string.h>

#include "console.h"

enum { buffer_size = 48 };

void print_text(const char* text) {
  console_write(text, strlen(text));
}

// value * 10^-digits.
static void print_decimal(bool negative, uint64_t value, unsigned digits, unsigned width) {
  char buffer[buffer_size];
  char* const end = buffer + buffer_size;
  char* first = end;
  for (unsigned position = 0; value != 0 || position <= digits; ++position) {
    if (position == digits && digits != 0) *--first = '.';
    *--first = (char)('0' + value % 10);
    value /= 10;
  }
  if (negative) *--first = '-';
  while ((unsigned)(end - first) < width && first != buffer) *--first = ' ';
  console_write(first, (size_t)(end - first));
}

static uint64_t magnitude(int64_t value) {
  return value < 0 ? 0 - (uint64_t)value : (uint64_t)value;
}

void print_unsigned(uint64_t value, unsigned width) {
  print_decimal(false, value, 0, width);
}

void print_signed(int64_t value, unsigned width) {
  print_decimal(value < 0, magnitude(value), 0, width);
}

void print_fixed(int64_t value, unsigned fraction_bits, unsigned digits, unsigned width) {
  const uint64_t one = 1ull << fraction_bits;
  uint64_t fraction = magnitude(value) & (one - 1);
  uint64_t decimal = magnitude(value) >> fraction_bits;
  // Digit by digit, so that no product needs more than fraction_bits + 4 bits.
  for (unsigned i = 0; i < digits; ++i) {
    fraction *= 10;
    decimal = decimal * 10 + (fraction >> fraction_bits);
    fraction &= one - 1;
  }
  if (2 * fraction >= one) ++decimal;
  print_decimal(value < 0 && decimal != 0, decimal, digits, width);
}

void print_q31(int32_t value, unsigned width) {
  print_fixed(value, 31, 9, width);
}

void print_radians(uint32_t angle, unsigned width) {
  // 2 pi = 6.28318530718 to the digit that 2^31 of it can move: the product stays below 2^64.
  const int32_t turn = (int32_t)angle;
  const uint64_t size = magnitude(turn);
  const uint64_t scaled = size * 6283185307ull + size * 18 / 100;
  const uint64_t nanoradians = (scaled + (1u << 31)) >> 32;
  print_decimal(turn < 0 && nanoradians != 0, nanoradians, 9, width);
}

void print_degrees(uint32_t angle, unsigned width) {
  print_fixed((int64_t)((uint64_t)angle * 360u), 32, 9, width);
}
