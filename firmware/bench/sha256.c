// Rounds as SHA-256 has them (FIPS 180-4, 6.2.2), with other constants: rotations, additions and
// choices over eight words that live in registers.
#include "bench.h"

enum { words = 64, blocks = 60000 };

static uint32_t constants[words];

static inline uint32_t rotate(uint32_t x, unsigned by) {
  return x >> by | x << (32 - by);
}

static void digest(uint32_t hash[8], const uint32_t message[16]) {
  uint32_t w[words];
  for (int i = 0; i < 16; ++i) w[i] = message[i];
  for (int i = 16; i < words; ++i) {
    const uint32_t far = w[i - 15], near = w[i - 2];
    w[i] = w[i - 16] + (rotate(far, 7) ^ rotate(far, 18) ^ far >> 3) + w[i - 7] +
           (rotate(near, 17) ^ rotate(near, 19) ^ near >> 10);
  }
  uint32_t a = hash[0], b = hash[1], c = hash[2], d = hash[3];
  uint32_t e = hash[4], f = hash[5], g = hash[6], h = hash[7];
  for (int i = 0; i < words; ++i) {
    const uint32_t first = h + (rotate(e, 6) ^ rotate(e, 11) ^ rotate(e, 25)) +
                           ((e & f) ^ (~e & g)) + constants[i] + w[i];
    const uint32_t second =
        (rotate(a, 2) ^ rotate(a, 13) ^ rotate(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    h = g;
    g = f;
    f = e;
    e = d + first;
    d = c;
    c = b;
    b = a;
    a = first + second;
  }
  const uint32_t out[8] = {a, b, c, d, e, f, g, h};
  for (int i = 0; i < 8; ++i) hash[i] += out[i];
}

int main(void) {
  uint32_t seed = 5, hash[8], message[16];
  for (int i = 0; i < words; ++i) constants[i] = next_random(&seed);
  for (int i = 0; i < 8; ++i) hash[i] = next_random(&seed);
  for (int i = 0; i < 16; ++i) message[i] = next_random(&seed);
  for (uint32_t block = 0; block < blocks; ++block) {
    message[block & 15] ^= hash[block & 7];
    digest(hash, message);
  }
  return report("sha256", hash[0] ^ hash[7]);
}
