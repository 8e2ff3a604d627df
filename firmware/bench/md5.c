// Rounds as MD5 has them (RFC 1321, 3.4), with other constants: a chain of additions and rotations
// in which every step waits for the one before.
#include "bench.h"

enum { steps = 64, blocks = 120000 };

static uint32_t constants[steps], message[16];

static inline uint32_t rotate_left(uint32_t x, unsigned by) {
  return x << by | x >> (32 - by);
}

static void digest(uint32_t hash[4]) {
  static const uint8_t turns[4][4] = {
      {7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};
  uint32_t a = hash[0], b = hash[1], c = hash[2], d = hash[3];
  for (unsigned i = 0; i < steps; ++i) {
    uint32_t mixed;
    unsigned word;
    switch (i / 16) {
      case 0:
        mixed = (b & c) | (~b & d);
        word = i;
        break;
      case 1:
        mixed = (d & b) | (~d & c);
        word = 5 * i + 1;
        break;
      case 2:
        mixed = b ^ c ^ d;
        word = 3 * i + 5;
        break;
      default:
        mixed = c ^ (b | ~d);
        word = 7 * i;
        break;
    }
    const uint32_t moved =
        b + rotate_left(a + mixed + constants[i] + message[word & 15], turns[i / 16][i & 3]);
    a = d;
    d = c;
    c = b;
    b = moved;
  }
  hash[0] += a;
  hash[1] += b;
  hash[2] += c;
  hash[3] += d;
}

int main(void) {
  uint32_t seed = 7, hash[4] = {1, 2, 3, 4};
  for (int i = 0; i < steps; ++i) constants[i] = next_random(&seed);
  for (int i = 0; i < 16; ++i) message[i] = next_random(&seed);
  for (uint32_t block = 0; block < blocks; ++block) {
    message[block & 15] ^= hash[block & 3];
    digest(hash);
  }
  return report("md5", hash[0] ^ hash[1] ^ hash[2] ^ hash[3]);
}
