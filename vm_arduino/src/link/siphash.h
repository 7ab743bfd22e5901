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

// Its steps, in `siphash_avr.S` or `siphash_portable.cpp`: XORs a word with another one; does rounds of
// the state.
constexpr uint8_t kWord = 8;  // bytes, little-endian
constexpr uint8_t kWords = 4;
void xor_word(uint8_t* word, const uint8_t* operand);
void sip_rounds(uint8_t* state, uint8_t rounds);

}  // namespace tiniscript
