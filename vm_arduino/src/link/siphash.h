// SipHash-2-4 of a short message: who cannot know the key cannot foresee it.
//
// Works byte by byte: on the AVR that takes a quarter of the flash of 64-bit numbers. Jean-Philippe
// Aumasson and Daniel J. Bernstein describe it in "SipHash: a fast short-input PRF".

#pragma once

#include <stdint.h>

namespace tiniscript {

constexpr uint8_t kHashBytes = 8;

// Puts the hash of `length` bytes (at most 247) under a key of 16 bytes into `hash`, which may be
// part of the message: little-endian, as the authors' test vectors have it.
void siphash(const uint8_t* key, const uint8_t* message, uint8_t length, uint8_t* hash);

}  // namespace tiniscript
