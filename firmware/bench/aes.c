// Rounds as AES has them (FIPS 197, 5.1), with another S-box: bytes through a table, rows that
// rotate, columns mixed over GF(2^8).
#include "bench.h"

enum { rounds = 10, blocks = 100000 };

static uint8_t box[256];
static uint8_t keys[rounds + 1][16];

static inline uint8_t doubled(uint8_t x) {
  return (uint8_t)(x << 1 ^ ((x >> 7) * 0x1B));
}

static void mix(uint8_t column[4]) {
  const uint8_t all = column[0] ^ column[1] ^ column[2] ^ column[3], first = column[0];
  for (int i = 0; i < 4; ++i) {
    const uint8_t next = i < 3 ? column[i + 1] : first;
    column[i] ^= all ^ doubled(column[i] ^ next);
  }
}

static void encrypt(uint8_t block[16]) {
  for (int i = 0; i < 16; ++i) block[i] ^= keys[0][i];
  for (int round = 1; round <= rounds; ++round) {
    uint8_t moved[16];
    for (int i = 0; i < 16; ++i) moved[i] = box[block[(i + 4 * (i & 3)) & 15]];
    for (int i = 0; i < 16 && round < rounds; i += 4) mix(moved + i);
    for (int i = 0; i < 16; ++i) block[i] = moved[i] ^ keys[round][i];
  }
}

int main(void) {
  uint32_t seed = 6, sum = 0;
  for (int i = 0; i < 256; ++i) box[i] = (uint8_t)i;
  for (int i = 255; i > 0; --i) {
    const uint32_t other = next_random(&seed) % (uint32_t)(i + 1);
    const uint8_t kept = box[i];
    box[i] = box[other];
    box[other] = kept;
  }
  for (int round = 0; round <= rounds; ++round)
    for (int i = 0; i < 16; ++i) keys[round][i] = (uint8_t)next_random(&seed);
  uint8_t block[16] = {0};
  for (uint32_t n = 0; n < blocks; ++n) encrypt(block);
  for (int i = 0; i < 16; ++i) sum = sum * 31 + block[i];
  return report("aes", sum);
}
