// Firmware driver of the CRC unit, at 0x40003000.
#include "an385.h"

#define CRC_UNIT ((struct { __IO uint32_t DATA, CRC, COUNT; }*)0x40003000u)
enum { CRC_UNIT_IRQn = 25 };

static inline uint32_t crc_of_words(const uint32_t* words, uint32_t count) {
  CRC_UNIT->COUNT = count;
  for (uint32_t i = 0; i < count; ++i) CRC_UNIT->DATA = words[i];
  return CRC_UNIT->CRC;
}
