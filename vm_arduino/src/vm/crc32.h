// The checksum of images, frames and records: the CRC-32 of zlib.

#pragma once

#include <stdint.h>

namespace tiniscript {

// Start with 0; pass the result on for the bytes that follow.
uint32_t crc32(uint32_t crc, const uint8_t* data, uint16_t length);

}  // namespace tiniscript
