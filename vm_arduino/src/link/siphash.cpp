#include "siphash.h"

#include "../vm/cpu.h"
#include "../vm/small.h"

namespace tiniscript {

// XORs a word with another one; and the rounds of the algorithm. On the AVR in `siphash_avr.S`.
void xor_word(uint8_t* word, const uint8_t* other);
void sip_rounds(uint8_t* state, uint8_t rounds);

namespace {

constexpr uint8_t kWord = 8;  // bytes, little-endian
constexpr uint8_t kWords = 4;
constexpr uint8_t kRounds = 2;  // after each word of the message
constexpr uint8_t kLastRounds = 4;

// The state before the key: "somepseudorandomlygeneratedbytes" in words.
const uint8_t kBegin[kWords * kWord + 1] tini_progmem = "uespemosmodnarodarenegylsetybdet";

}  // namespace

#ifndef __AVR__

namespace {

// Rotates a word to the left.
void rotate(uint8_t* word, uint8_t bits) {
  while (bits-- != 0) {
    uint8_t carry = static_cast<uint8_t>(word[kWord - 1] >> 7);
    for (uint8_t k = 0; k < kWord; k++) {
      const uint8_t byte = word[k];
      word[k] = static_cast<uint8_t>(byte << 1 | carry);
      carry = static_cast<uint8_t>(byte >> 7);
    }
  }
}

// The quarters of a round: where two words lie, by how much the second one is rotated before it is
// XORed with the sum that replaces the first one, and by how much the first one is rotated then.
const uint8_t kQuarters[] = {
    0 * kWord, 1 * kWord, 13, 32,  //
    2 * kWord, 3 * kWord, 16, 0,   //
    0 * kWord, 3 * kWord, 21, 0,   //
    2 * kWord, 1 * kWord, 17, 32,
};

}  // namespace

void xor_word(uint8_t* word, const uint8_t* other) {
  for (uint8_t k = 0; k < kWord; k++) word[k] ^= other[k];
}

void sip_rounds(uint8_t* state, uint8_t rounds) {
  do {
    const uint8_t* row = kQuarters;
    do {
      uint8_t* const first = state + *row++;
      uint8_t* const second = state + *row++;
      uint8_t carry = 0;
      for (uint8_t k = 0; k < kWord; k++) {
        const uint16_t sum = static_cast<uint16_t>(first[k] + second[k] + carry);
        first[k] = static_cast<uint8_t>(sum);
        carry = static_cast<uint8_t>(sum >> 8);
      }
      rotate(second, *row++);
      xor_word(second, first);
      rotate(first, *row++);
    } while (row != kQuarters + sizeof kQuarters);
  } while (--rounds != 0);
}

#endif  // __AVR__

tini_noinline void siphash(const uint8_t* key, const uint8_t* message, uint8_t length,
                           uint8_t* hash) {
  uint8_t state[kWords * kWord];
  for (uint8_t k = 0; k < sizeof state; k++) {
    state[k] = static_cast<uint8_t>(flash_byte(kBegin + k) ^ key[k % (2 * kWord)]);
  }
  uint8_t at = 0;
  uint8_t word[kWord];
  do {
    for (uint8_t k = 0; k < kWord; k++) {
      const uint8_t place = static_cast<uint8_t>(at + k);
      word[k] = place < length ? message[place] : 0;
    }
    at = static_cast<uint8_t>(at + kWord);
    if (at > length) word[kWord - 1] = length;
    xor_word(state + 3 * kWord, word);
    sip_rounds(state, kRounds);
    xor_word(state, word);
  } while (at <= length);
  state[2 * kWord] ^= 0xff;
  sip_rounds(state, kLastRounds);
  for (uint8_t k = 0; k < kWord; k++) {
    hash[k] = static_cast<uint8_t>(state[k] ^ state[k + kWord] ^ state[k + 2 * kWord] ^
                                   state[k + 3 * kWord]);
  }
}

}  // namespace tiniscript
