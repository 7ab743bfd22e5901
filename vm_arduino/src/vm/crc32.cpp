#ifndef __AVR__

#include "crc32.h"

namespace tiniscript {

uint32_t crc32(uint32_t crc, const uint8_t* data, uint16_t length) {
  crc = ~crc;
  while (length-- != 0) {
    crc ^= *data++;
    for (uint8_t bit = 0; bit < 8; bit++) {
      const bool carry = (crc & 1) != 0;
      crc >>= 1;
      if (carry) crc ^= 0xedb88320;
    }
  }
  return ~crc;
}

}  // namespace tiniscript

#endif  // __AVR__
