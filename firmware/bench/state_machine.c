// A scanner for numbers in text, one state a character: branches that depend on data.
#include "bench.h"

enum { length = 4096, rounds = 18000 };
enum state { start, sign, integer, point, fraction, exponent, exponent_digits, invalid, states };

static char text[length];

static enum state next_state(enum state s, char c) {
  const int digit = c >= '0' && c <= '9';
  switch (s) {
    case start:
      return digit ? integer : c == '-' ? sign : c == '.' ? point : c == ',' ? start : invalid;
    case sign:
      return digit ? integer : c == '.' ? point : invalid;
    case integer:
      return digit      ? integer
             : c == '.' ? fraction
             : c == 'e' ? exponent
             : c == ',' ? start
                        : invalid;
    case point:
      return digit ? fraction : invalid;
    case fraction:
      return digit ? fraction : c == 'e' ? exponent : c == ',' ? start : invalid;
    case exponent:
      return digit || c == '-' ? exponent_digits : invalid;
    case exponent_digits:
      return digit ? exponent_digits : c == ',' ? start : invalid;
    default:
      return c == ',' ? start : invalid;
  }
}

int main(void) {
  static const char alphabet[] = "01234567890123456789.-e,,,x";
  uint32_t seed = 3, sum = 0, visits[states] = {0};
  for (int i = 0; i < length; ++i) {
    text[i] = alphabet[next_random(&seed) % (sizeof alphabet - 1)];
  }
  for (uint32_t round = 0; round < rounds; ++round) {
    enum state s = start;
    for (int i = 0; i < length; ++i) {
      s = next_state(s, text[i]);
      ++visits[s];
    }
    text[next_random(&seed) % length] = alphabet[next_random(&seed) % (sizeof alphabet - 1)];
  }
  for (int s = 0; s < states; ++s) sum = sum * 31 + visits[s];
  return report("state_machine", sum);
}
