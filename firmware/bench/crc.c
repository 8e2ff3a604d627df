// CRC-32 (IEEE 802.3) by a table, and bit by bit for a part of the data: shifts and exclusive ors.
#include "bench.h"

enum { length = 8192, rounds = 9000 };

static uint8_t data[length];
static uint32_t table[256];

static uint32_t bit_by_bit(uint32_t crc, uint8_t byte) {
  crc ^= byte;
  for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (0xEDB88320u & (0u - (crc & 1)));
  return crc;
}

int main(void) {
  uint32_t seed = 4, crc = ~0u;
  for (int i = 0; i < length; ++i) data[i] = (uint8_t)next_random(&seed);
  for (uint32_t i = 0; i < 256; ++i) table[i] = bit_by_bit(i, 0);
  for (uint32_t round = 0; round < rounds; ++round) {
    for (int i = 0; i < length; ++i) crc = crc >> 8 ^ table[(crc ^ data[i]) & 0xFF];
    for (int i = 0; i < 1024; ++i) crc = bit_by_bit(crc, data[i]);
  }
  return report("crc", ~crc);
}
